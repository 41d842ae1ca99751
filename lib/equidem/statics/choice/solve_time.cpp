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
  // Fitted to hexagonal blocks and triangulations of 2e3 to 1e6 discs, on one thread and on two. What more threads
  // gain, and what lies outside the cache, grows with the sample; with either method a second thread gains 65 % at
  // most.
  const double share_in_parallel = estimate.discs / (estimate.discs + 2e4);
  const double speed_up = 1 + 0.65 * share_in_parallel * (threads - 1);
  if (estimate.method == SolverMethod::multigrid) {
    constexpr double of_grids = 1.0 / 3;
    const double out_of_cache = 1 + 0.3 * estimate.discs / (estimate.discs + 3e4);
    return out_of_cache * estimate.discs * rates.per_disc * (of_grids + (1 - of_grids) * solutions) / speed_up;
  }
  // In single precision operations take half the time; steps of conjugate gradients take most of what entries save.
  const double of_entry = estimate.single_precision ? 0.95 : 1, of_operation = estimate.single_precision ? 0.5 : 1;
  const double seconds =
      of_entry * estimate.factor_nonzeros * rates.per_entry + of_operation * estimate.operations * rates.per_operation;
  return solutions * seconds / speed_up;
}

}  // namespace equidem
