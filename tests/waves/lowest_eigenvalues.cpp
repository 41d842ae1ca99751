// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The lowest eigenvalues of operators that are known.
#include "equidem/waves/lowest_eigenvalues.hpp"

#include <cmath>

#include "support/catch.hpp"

using namespace equidem;

namespace {

/// diag(lambda), with an inverse that is off by a share, alternately too large and too small.
LowestEigenvalues lowest_of(const std::vector<double>& lambda, double share, const LowestOptions& options) {
  TallMatrix null(lambda.size(), 0);
  for (std::size_t k = 0; k < lambda.size(); ++k) {
    if (lambda[k] != 0) continue;
    TallMatrix more(lambda.size(), null.columns() + 1);
    std::ranges::copy(std::as_const(null).column(0, null.columns()), more.column(0, null.columns()).begin());
    more(k, null.columns()) = 1;
    null = more;
  }
  const SymmetricOperator a{.size = lambda.size(),
                            .multiply =
                                [&](const TallMatrix& x, ColumnRange columns, TallMatrix& y) {
                                  for (std::size_t c = columns.first; c < columns.first + columns.count; ++c)
                                    for (std::size_t k = 0; k < lambda.size(); ++k) y(k, c) = lambda[k] * x(k, c);
                                },
                            .precondition =
                                [&](TallMatrix& x, ColumnRange columns) {
                                  for (std::size_t c = columns.first; c < columns.first + columns.count; ++c) {
                                    for (std::size_t k = 0; k < lambda.size(); ++k) {
                                      const double off = 1 + (k % 2 == 0 ? share : -share);
                                      x(k, c) = lambda[k] == 0 ? 1.0 : off * x(k, c) / lambda[k];
                                    }
                                  }
                                }};
  return lowest_eigenvalues(a, null, options);
}

}  // namespace

TEST_CASE("an_approximate_inverse_leads_to_the_same_eigenvalues_within_their_bounds") {
  for (const double share : {0.0, 0.03, 0.3}) {
    for (const double tolerance : {1e-3, 1e-6, 1e-9}) {
      std::vector<double> lambda{0, 0};
      for (int k = 1; k <= 400; ++k) {
        for (int copy = 0; copy <= k % 3; ++copy) lambda.push_back(std::pow(k, 2));  // 1 1 4 4 4 9 16 16
      }
      const LowestEigenvalues found = lowest_of(lambda, share, {.wanted = 8, .tolerance = tolerance});
      CAPTURE(share, tolerance, found.iterations, found.values, found.error_bounds);
      REQUIRE(found.values.size() == 8);
      CHECK(found.converged);
      for (std::size_t k = 0; k < 8; ++k) {
        CHECK(std::abs(found.values[k] - lambda[k + 2]) <= found.error_bounds[k] + 1e-12);
        CHECK(found.error_bounds[k] <= tolerance * found.values[k]);
      }
    }
  }
}

TEST_CASE("work_that_does_not_suffice_is_said_with_bounds_that_hold") {
  std::vector<double> lambda;
  for (int k = 1; k <= 3000; ++k) lambda.push_back(1 + 1e-4 * k);
  const LowestEigenvalues found = lowest_of(lambda, 0.2, {.wanted = 2, .tolerance = 1e-10, .iterations = 3});
  CAPTURE(found.values, found.error_bounds);
  CHECK(!found.converged);
  CHECK(found.iterations == 3);
  for (std::size_t k = 0; k < 2; ++k) {
    const double nearest = 1 + 1e-4 * std::round((found.values[k] - 1) / 1e-4);
    CHECK(std::abs(found.values[k] - nearest) <= found.error_bounds[k]);
    CHECK(found.values[k] >= lambda[k]);
  }
}
