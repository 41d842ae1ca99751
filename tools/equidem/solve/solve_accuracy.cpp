// SPDX-License-Identifier: GPL-3.0-or-later
#include "solve/solve_accuracy.hpp"

#include <algorithm>
#include <cmath>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

#include "prestressed.hpp"

namespace equidem {
namespace {

constexpr double most_discs = 1e6;
constexpr double work_per_rows = 2.4;  // time of a plane block of n x n discs as n^2.4, a little above that of n²

std::int64_t one_beyond_a_multiple_of_four(double n) {
  return 4 * std::max<std::int64_t>(1, static_cast<std::int64_t>(std::ceil((n - 1) / 4 - 1e-9))) + 1;
}

double aspect_of(const Case& resolved) {
  return static_cast<double>(resolved.assembly.lattice.columns) / resolved.assembly.lattice.rows;
}

RefinementOptions block_refinement(double aspect, double accuracy) {
  return {.accuracy = accuracy,
          .order = 1,
          .first = one_beyond_a_multiple_of_four(std::max(9.0, 9 / aspect)),
          .most = one_beyond_a_multiple_of_four(std::sqrt(most_discs / aspect)) - 4,
          .unit = "rows",
          .admissible = [](std::int64_t n) { return one_beyond_a_multiple_of_four(static_cast<double>(n)); }};
}

/// Rows, and columns in the proportion of the case.
AccuracySetting setting_of(double aspect, std::int64_t rows) {
  const double across = std::round(aspect * static_cast<double>(rows));
  return {{"assembly.rows", static_cast<double>(rows)},
          {"assembly.columns", static_cast<double>(one_beyond_a_multiple_of_four(across))}};
}

std::vector<double> solve_block(Case resolved) {
  const Problem problem = prestressed(build_problem(std::move(resolved)));
  const EquilibriumSolver solver(problem.assembly, problem.springs.springs, problem.supports, problem.options());
  return BlockSearch::values_of(*solve_case(problem, solver, problem.load_cases.front()).tension);
}

}  // namespace

bool BlockSearch::serves(const Case& resolved) {
  return resolved.test && resolved.assembly.arrangement != nullptr;
}

BlockSearch::BlockSearch(const CommonOptions& options, const Case& resolved, double accuracy)
    : CaseSearch(
          options, block_refinement(aspect_of(resolved), accuracy),
          [aspect = aspect_of(resolved)](std::int64_t rows) { return setting_of(aspect, rows); }, solve_block),
      of_case_(fmt::format("{} x {}", resolved.assembly.lattice.columns, resolved.assembly.lattice.rows)) {}

std::vector<double> BlockSearch::values_of(const TensionResult& result) {
  return {result.poisson_ratio, std::log(std::abs(result.stiffness_ratio))};
}

ReachedAccuracy BlockSearch::reached() const {
  ReachedAccuracy reached =
      reached_accuracy("nu, and 2G/((1-nu)kN) relative, of this block against the lattice without sides, extrapolated",
                       fmt::format("the size of the block, {} in the case", of_case_), work_per_rows);
  const auto [fewest, most] = std::ranges::minmax(pilots());
  reached.pilots = fmt::format("{} of {} to {} rows",
                               counted(std::ssize(pilots()) + std::ssize(proposed()) - 1, "block"), fewest, most);
  reached.pilots_factor = seconds_before() / seconds();
  auto& more = reached.ten_times_more;
  if (const double rows = more.value[0].second, columns = more.value[1].second; rows * columns > most_discs) {
    more.note = fmt::format(
        "{} x {} discs, more than are tried; a periodic cell has no sides: 'equidem homogenize' gives both to "
        "round-off",
        columns, rows);
  }
  return reached;
}

ReachedAccuracy solver_accuracy(double accuracy, double error_bound, double condition, double seconds) {
  if (!(error_bound > 0) || error_bound > accuracy) {
    computation_failed(fmt::format("an accuracy of {:.3g} cannot be reached", accuracy),
                       error_bound <= 0 ? "this solver gives no bound of its error"
                       : condition > 0  ? fmt::format("the answer is known to {:.2g}: its condition is about {:.1e}",
                                                      error_bound, condition)
                                        : fmt::format("the answer is known to {:.2g}", error_bound),
                       error_bound > 0 ? "Ask for less, or give the assembly with fewer extremes of size or stiffness"
                                       : "Set solver.method = \"auto\"");
  }
  ReachedAccuracy reached{
      .requested = accuracy,
      .estimated = error_bound,
      .of = fmt::format("the answer to this assembly, {}; what the assembly stands for is not judged",
                        condition > 0 ? "bound from the residual and the condition" : "estimated from the iterations"),
      .knob = {},
      .value = {},
      .pilots = {},
      .pilots_factor = 0,
      .ten_times_more = {.time_factor = 1, .seconds = seconds, .value = {}, .note = {}}};
  if (condition == 0) {
    reached.ten_times_more.note = "about two iterations more";
    return reached;
  }
  reached.ten_times_more.note = error_bound <= accuracy / 10
                                    ? "nothing: the direct solution has it already"
                                    : "cannot be had: the direct solution is refined as far as doubles go";
  return reached;
}

}  // namespace equidem
