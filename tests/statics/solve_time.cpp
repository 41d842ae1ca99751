// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/statics/choice/solve_time.hpp"

#include "equidem/core/threads.hpp"

#include "support/catch.hpp"

using namespace equidem;

TEST_CASE("a_predicted_time_grows_with_entries_and_operations_and_falls_with_threads") {
  const int threads = thread_count();
  const SolveRates rates = measure_solve_rates(SolverMethod::multifrontal);
  CHECK(thread_count() == threads);
  CAPTURE(rates.per_entry, rates.per_operation);
  CHECK(rates.per_entry > 0);
  CHECK(rates.per_operation > 0);
  const SolveEstimate small{.discs = 1e5, .factor_nonzeros = 1e6, .operations = 1e8};
  SolveEstimate fuller = small, harder = small, rounded = small, tiny = small;
  fuller.factor_nonzeros *= 2;
  harder.operations *= 2;
  rounded.single_precision = true;
  tiny.discs = 1e3;
  const double base = estimate_seconds(small, 1, rates, 1);
  CHECK(estimate_seconds(fuller, 1, rates, 1) > base);
  CHECK(estimate_seconds(harder, 1, rates, 1) > base);
  CHECK(estimate_seconds(rounded, 1, rates, 1) < base);
  CHECK(estimate_seconds(tiny, 1, rates, 1) == base);
  CHECK(estimate_seconds(tiny, 1, rates, 2) > 0.9 * base);
  CHECK(estimate_seconds(small, 1, rates, 2) < 0.7 * base);
  CHECK(estimate_seconds(small, 1, rates, 2) > base / 2);
  CHECK(estimate_seconds(small, 3, rates, 1) == Approx(3 * base));
}

TEST_CASE("a_predicted_time_of_multigrid_grows_with_discs_and_with_load_cases_less_than_in_proportion") {
  const SolveRates rates = measure_solve_rates(SolverMethod::multigrid);
  CHECK(rates.per_disc > 0);
  const SolveEstimate sample{.method = SolverMethod::multigrid, .discs = 1e5};
  const SolveEstimate larger{.method = SolverMethod::multigrid, .discs = 2e5};
  const double base = estimate_seconds(sample, 1, rates, 1);
  CHECK(estimate_seconds(larger, 1, rates, 1) == Approx(2.06 * base).epsilon(0.03));  // out of the cache
  CHECK(estimate_seconds(sample, 3, rates, 1) > 2 * base);
  CHECK(estimate_seconds(sample, 3, rates, 1) < 3 * base);
}
