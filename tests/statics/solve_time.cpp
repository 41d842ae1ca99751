// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/statics/solve_time.hpp"

#include "equidem/core/threads.hpp"

#include "support/catch.hpp"

using namespace equidem;

TEST_CASE("a_predicted_time_grows_with_entries_and_operations_and_falls_with_threads") {
  const int threads = thread_count();
  const SolveRates rates = measure_solve_rates();
  CHECK(thread_count() == threads);
  CAPTURE(rates.per_entry, rates.per_operation);
  CHECK(rates.per_entry > 0);
  CHECK(rates.per_operation > 0);
  const SolveEstimate small{.factor_nonzeros = 1e6, .operations = 1e8};
  const SolveEstimate fuller{.factor_nonzeros = 2e6, .operations = 1e8},
      harder{.factor_nonzeros = 1e6, .operations = 2e8};
  const double base = estimate_seconds(small, rates, 1);
  CHECK(estimate_seconds(fuller, rates, 1) > base);
  CHECK(estimate_seconds(harder, rates, 1) > base);
  CHECK(estimate_seconds(small, rates, 2) < base);
  CHECK(estimate_seconds(small, rates, 2) > base / 2);
}
