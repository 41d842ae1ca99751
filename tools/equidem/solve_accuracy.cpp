// SPDX-License-Identifier: GPL-3.0-or-later
#include "solve_accuracy.hpp"

#include <algorithm>
#include <cmath>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/study/refinement.hpp"

namespace equidem {
namespace {

constexpr double most_discs = 1e6;
constexpr double work_per_rows = 2.4;  // time of a plane block of n x n discs as n^2.4, a little above that of n²

std::int64_t one_beyond_a_multiple_of_four(double n) {
  return 4 * std::max<std::int64_t>(1, static_cast<std::int64_t>(std::ceil((n - 1) / 4 - 1e-9))) + 1;
}

struct Block {
  std::int64_t rows = 0, columns = 0;

  [[nodiscard]] std::vector<std::string> keys() const {
    return {format("assembly.rows={}", rows), format("assembly.columns={}", columns)};
  }
  [[nodiscard]] AccuracySetting setting() const {
    return {{"assembly.rows", static_cast<double>(rows)}, {"assembly.columns", static_cast<double>(columns)}};
  }
};

}  // namespace

std::optional<ReachedAccuracy> choose_block(CommonOptions& options, double accuracy) {
  const Case resolved = read_case(options);
  const AssemblyKind kind = resolved.assembly.kind;
  if (!resolved.test || (kind != AssemblyKind::hexagonal && kind != AssemblyKind::square)) return {};
  const LatticeOptions& lattice = resolved.assembly.lattice;
  const double aspect = static_cast<double>(lattice.columns) / lattice.rows;
  const auto block_of = [&](std::int64_t rows) {
    return Block{rows, one_beyond_a_multiple_of_four(std::round(aspect * static_cast<double>(rows)))};
  };
  double seconds = 0;  // of the last one
  const auto evaluate = [&](std::int64_t rows) {
    CommonOptions sized = options;
    for (const std::string& key : block_of(rows).keys()) sized.set.push_back(key);
    Stopwatch watch;
    const Problem problem = build_problem(read_case(sized));
    const EquilibriumSolver solver(problem.assembly, problem.springs.springs, problem.supports, problem.options());
    const SolvedCase solved = solve_case(problem, solver, problem.load_cases.front());
    seconds = watch.lap();
    return std::vector{solved.tension->poisson_ratio, std::log(std::abs(solved.tension->stiffness_ratio))};
  };
  const Refinement refined = refine_to(
      evaluate, {.accuracy = accuracy,
                 .order = 1,
                 .first = one_beyond_a_multiple_of_four(std::max(9.0, 9 / aspect)),
                 .most = one_beyond_a_multiple_of_four(std::sqrt(most_discs / aspect)) - 4,
                 .admissible = [](std::int64_t n) { return one_beyond_a_multiple_of_four(static_cast<double>(n)); }});
  const Block chosen = block_of(refined.level);
  evaluate(refined.level);
  for (const std::string& key : chosen.keys()) options.set.push_back(key);
  const Block finer = block_of(one_beyond_a_multiple_of_four(static_cast<double>(refined.level_for(accuracy / 10))));
  const double factor = std::pow(static_cast<double>(finer.rows) / static_cast<double>(refined.level), work_per_rows);
  ReachedAccuracy reached{
      .requested = accuracy,
      .estimated = refined.estimated,
      .of = format(
          "nu, and 2G/((1-nu)kN) relative, of this block against the lattice without sides, extrapolated from {} "
          "blocks of up to {} rows (errors fall as rows^-{:.2f})",
          refined.levels.size(), *std::max_element(refined.levels.begin(), refined.levels.end()), refined.order),
      .knob = format("the size of the block, {} x {} in the case", lattice.columns, lattice.rows),
      .value = chosen.setting(),
      .ten_times_more = {.time_factor = factor, .seconds = factor * seconds, .value = finer.setting(), .note = {}}};
  if (static_cast<double>(finer.rows) * static_cast<double>(finer.columns) > most_discs) {
    reached.ten_times_more.note = format(
        "{} x {} discs, more than are tried; a periodic cell has no sides: 'equidem homogenize' gives both to "
        "round-off",
        finer.columns, finer.rows);
  }
  return reached;
}

ReachedAccuracy solver_accuracy(double accuracy, double error_bound, double condition, double seconds) {
  if (!(error_bound > 0) || error_bound > accuracy) {
    computation_failed(
        format("an accuracy of {:.3g} cannot be reached", accuracy),
        error_bound > 0 ? format("the answer is known to {:.2g}: its condition is about {:.1e}", error_bound, condition)
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
      .ten_times_more = {.time_factor = 1, .seconds = seconds, .value = {}, .note = {}}};
  reached.ten_times_more.note = error_bound <= accuracy / 10
                                    ? "nothing: the direct solution has it already"
                                    : "cannot be had: the direct solution is refined as far as doubles go";
  return reached;
}

}  // namespace equidem
