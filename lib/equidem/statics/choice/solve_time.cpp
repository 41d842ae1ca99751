// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/statics/choice/solve_time.hpp"

#include <algorithm>
#include <limits>
#include <vector>

#include "equidem/assembly/lattices/hexagonal.hpp"
#include "equidem/core/stopwatch.hpp"
#include "equidem/core/threads.hpp"
#include "equidem/linear/multifrontal/dense_kernels.hpp"
#include "equidem/statics/equilibrium.hpp"

namespace equidem {
namespace {

constexpr int rounds = 3;

template <typename Task>
double least_seconds(const Task& task) {
  double least = std::numeric_limits<double>::infinity();
  for (int round = 0; round < rounds; ++round) {
    const Stopwatch watch;
    task();
    least = std::min(least, watch.seconds());
  }
  return least;
}

double seconds_per_operation() {
  constexpr std::size_t n = 384;
  const std::vector<double> a(n * n, 1e-3);
  std::vector<double> c(n * n, 0.0);
  dense::use_one_thread_per_call();
  const double seconds =
      least_seconds([&] { dense::subtract_product_transposed(n, n, n, a.data(), n, a.data(), n, c.data(), n); });
  return seconds / (2.0 * n * n * n);
}

/// The least time of the solution of a block with the bound of its error, on one thread.
double seconds_of_block(const Assembly& block, SolverMethod method, SolveEstimate* estimate = nullptr) {
  const ContactSprings springs(SpringConstants{1, 0.5});
  const std::vector<Support> supports{{.group = "left", .ux = 0, .uy = 0, .rotation = {}}};
  const LoadCase loads{{.group = "right", .force = {1, 0}}};
  EquilibriumOptions options;
  options.error_bound = true;
  options.solver.method = method;
  if (estimate != nullptr) *estimate = estimate_solve(block, springs, supports, options);
  const int threads = thread_count();
  set_thread_count(1);
  const double seconds =
      least_seconds([&] { static_cast<void>(EquilibriumSolver(block, springs, supports, options).solve(loads)); });
  set_thread_count(threads);
  return seconds;
}

}  // namespace

SolveRates measure_solve_rates(SolverMethod method) {
  const auto block = [](int rows) { return hexagonal_lattice({.columns = rows, .rows = rows, .radius = 1}); };
  if (method == SolverMethod::multigrid) {
    const Assembly large = block(90);
    return {.per_disc = seconds_of_block(large, method) / static_cast<double>(large.size())};
  }
  SolveEstimate estimate;
  const double seconds = seconds_of_block(block(41), SolverMethod::multifrontal, &estimate);
  SolveRates rates{.per_operation = seconds_per_operation()};
  rates.per_entry = std::max(0.0, seconds - estimate.operations * rates.per_operation) / estimate.factor_nonzeros;
  return rates;
}

double estimate_seconds(const SolveEstimate& estimate, double solutions, const SolveRates& rates, int threads) {
  constexpr double efficiency = 0.8;  // of a second thread, measured at 1e5 and 1e6 discs
  const double speed_up = 1 + efficiency * (threads - 1);
  if (estimate.method == SolverMethod::multigrid) {
    constexpr double of_grids = 1.0 / 3, out_of_cache = 1.3;
    return out_of_cache * estimate.discs * rates.per_disc * (of_grids + (1 - of_grids) * solutions) / speed_up;
  }
  const double seconds = estimate.factor_nonzeros * rates.per_entry + estimate.operations * rates.per_operation;
  return solutions * seconds / speed_up;
}

}  // namespace equidem
