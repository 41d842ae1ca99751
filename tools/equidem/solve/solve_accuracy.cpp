// SPDX-License-Identifier: GPL-3.0-or-later
#include "solve/solve_accuracy.hpp"

#include <algorithm>
#include <cmath>

#include "equidem/core/error.hpp"
#include "equidem/core/stopwatch.hpp"
#include "equidem/core/text.hpp"

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

std::vector<double> values_of(const TensionResult& result) {
  return {result.poisson_ratio, std::log(std::abs(result.stiffness_ratio))};
}

}  // namespace

bool BlockSearch::serves(const Case& resolved) {
  return resolved.test && resolved.assembly.arrangement != nullptr;
}

BlockSearch::BlockSearch(const CommonOptions& options, const Case& resolved, double accuracy)
    : options_(options),
      accuracy_(accuracy),
      aspect_(aspect_of(resolved)),
      of_case_(fmt::format("{} x {}", resolved.assembly.lattice.columns, resolved.assembly.lattice.rows)),
      search_([this](std::int64_t rows) { return solve_pilot(rows); }, block_refinement(aspect_, accuracy)) {}

Case BlockSearch::propose() {
  proposed_.push_back(search_.propose());
  return case_of(proposed_.back());
}

bool BlockSearch::accepts(const TensionResult& result, double seconds) {
  other_seconds_ += seconds_;
  seconds_ = seconds;
  return search_.accepts(proposed_.back(), values_of(result));
}

ReachedAccuracy BlockSearch::reached() const {
  const std::int64_t rows = proposed_.back();
  const bool enough = search_.error(rows) <= accuracy_ / 10;
  const Size finer = size_of(
      enough ? rows : one_beyond_a_multiple_of_four(static_cast<double>(search_.level_for(accuracy_ / 10, rows))));
  const double factor = std::pow(static_cast<double>(finer.rows) / static_cast<double>(rows), work_per_rows);
  const auto& pilots = search_.pilots();
  ReachedAccuracy reached{
      .requested = accuracy_,
      .estimated = search_.error(rows),
      .of = fmt::format("nu, and 2G/((1-nu)kN) relative, of this block against the lattice without sides, extrapolated "
                        "(errors fall as rows^-{:.2f})",
                        search_.order()),
      .knob = fmt::format("the size of the block, {} in the case", of_case_),
      .value = setting_of(size_of(rows)),
      .pilots =
          fmt::format("{} of {} to {} rows", counted(std::ssize(pilots) + std::ssize(proposed_) - 1, "block"),
                      *std::min_element(pilots.begin(), pilots.end()), *std::max_element(pilots.begin(), pilots.end())),
      .pilots_factor = other_seconds_ / seconds_,
      .ten_times_more = {.time_factor = factor,
                         .seconds = factor * seconds_,
                         .value = setting_of(finer),
                         .note = enough ? has_it_already : ""}};
  if (static_cast<double>(finer.rows) * static_cast<double>(finer.columns) > most_discs) {
    reached.ten_times_more.note = fmt::format(
        "{} x {} discs, more than are tried; a periodic cell has no sides: 'equidem homogenize' gives both to "
        "round-off",
        finer.columns, finer.rows);
  }
  return reached;
}

BlockSearch::Size BlockSearch::size_of(std::int64_t rows) const {
  return {rows, one_beyond_a_multiple_of_four(std::round(aspect_ * static_cast<double>(rows)))};
}

Case BlockSearch::case_of(std::int64_t rows) const {
  const Size size = size_of(rows);
  CommonOptions sized = options_;
  sized.set.push_back(fmt::format("assembly.rows={}", size.rows));
  sized.set.push_back(fmt::format("assembly.columns={}", size.columns));
  return read_case(sized);
}

AccuracySetting BlockSearch::setting_of(const Size& size) {
  return {{"assembly.rows", static_cast<double>(size.rows)}, {"assembly.columns", static_cast<double>(size.columns)}};
}

std::vector<double> BlockSearch::solve_pilot(std::int64_t rows) {
  const Stopwatch watch;
  const Problem problem = build_problem(case_of(rows));
  const EquilibriumSolver solver(problem.assembly, problem.springs.springs, problem.supports, problem.options());
  const SolvedCase solved = solve_case(problem, solver, problem.load_cases.front());
  other_seconds_ += watch.seconds();
  return values_of(*solved.tension);
}

ReachedAccuracy solver_accuracy(double accuracy, double error_bound, double condition, double seconds) {
  if (!(error_bound > 0) || error_bound > accuracy) {
    computation_failed(fmt::format("an accuracy of {:.3g} cannot be reached", accuracy),
                       error_bound > 0 ? fmt::format("the answer is known to {:.2g}: its condition is about {:.1e}",
                                                     error_bound, condition)
                                       : "this solver gives no bound of its error",
                       error_bound > 0 ? "Ask for less, or give the assembly with fewer extremes of size or stiffness"
                                       : "Set solver.method = \"auto\"");
  }
  ReachedAccuracy reached{
      .requested = accuracy,
      .estimated = error_bound,
      .of =
          "the answer to this assembly, bound from the residual and the condition; what the assembly stands for is "
          "not judged",
      .knob = {},
      .value = {},
      .pilots = {},
      .pilots_factor = 0,
      .ten_times_more = {.time_factor = 1, .seconds = seconds, .value = {}, .note = {}}};
  reached.ten_times_more.note = error_bound <= accuracy / 10
                                    ? "nothing: the direct solution has it already"
                                    : "cannot be had: the direct solution is refined as far as doubles go";
  return reached;
}

}  // namespace equidem
