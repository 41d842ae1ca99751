// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Eigenvalues of operators that are known.
#include "equidem/waves/extreme_eigenvalues.hpp"

#include <algorithm>
#include <cmath>

#include "equidem/core/error.hpp"

#include "support/catch.hpp"

using namespace equidem;

namespace {

/// diag(lambda), with an inverse that is off by a share, alternately too large and too small.
LowestEigenvalues lowest_of(const std::vector<double>& lambda, double share, const LowestOptions& options) {
  const std::size_t n = lambda.size();
  std::vector<double> null;
  for (std::size_t k = 0; k < n; ++k) {
    if (lambda[k] != 0) continue;
    null.resize(null.size() + n);
    null[null.size() - n + k] = 1;
  }
  const SymmetricOperator a{.size = n,
                            .dimension = n - null.size() / n,
                            .multiply =
                                [&](std::span<const double> x, std::span<double> y) {
                                  for (std::size_t k = 0; k < x.size(); ++k) y[k] = lambda[k % n] * x[k];
                                },
                            .solve =
                                [&](std::span<double> x) {
                                  for (std::size_t k = 0; k < x.size(); ++k) {
                                    const double off = 1 + (k % n % 2 == 0 ? share : -share);
                                    x[k] = lambda[k % n] == 0 ? 1.0 : off * x[k] / lambda[k % n];
                                  }
                                }};
  return lowest_eigenvalues(a, null, options);
}

}  // namespace

TEST_CASE("multiple_eigenvalues_are_found_as_often_as_they_occur") {
  const double scale = GENERATE(1.0, 1e-100, 1e100);
  const int copies = GENERATE(1, 2, 3, 7, 12);
  for (const double share : {0.0, 1e-9, 0.03}) {
    for (const double tolerance : {1e-3, 1e-6, 1e-9}) {
      std::vector<double> lambda{0, 0};
      for (int k = 1; k <= 400; ++k) {
        for (int copy = 0; copy <= (k % 2 == 0 ? 0 : copies - 1); ++copy) lambda.push_back(scale * std::pow(k, 2));
      }
      const LowestEigenvalues found = lowest_of(lambda, share, {.wanted = 8, .tolerance = tolerance});
      CAPTURE(scale, copies, share, tolerance, found.iterations, found.values, found.error_bounds);
      REQUIRE(found.values.size() == 8);
      CHECK(found.iterations > 0);
      CHECK(found.converged);
      for (std::size_t k = 0; k < 8; ++k) {
        CHECK(std::abs(found.values[k] - lambda[k + 2]) <= found.error_bounds[k] + 1e-12 * scale);
        CHECK(found.error_bounds[k] <= tolerance * found.values[k]);
      }
    }
  }
}

TEST_CASE("work_that_does_not_suffice_is_said_with_bounds_that_hold") {
  std::vector<double> lambda;
  for (int k = 1; k <= 3000; ++k) lambda.push_back(1 + 1e-4 * k);
  const LowestEigenvalues found = lowest_of(lambda, 0, {.wanted = 2, .tolerance = 1e-12, .corrections = 0});
  CAPTURE(found.values, found.error_bounds);
  CHECK(!found.converged);
  for (std::size_t k = 0; k < 2; ++k) {
    const double nearest = 1 + 1e-4 * std::round((found.values[k] - 1) / 1e-4);
    CHECK(std::abs(found.values[k] - nearest) <= found.error_bounds[k]);
    CHECK(found.values[k] >= lambda[k]);
  }
}

TEST_CASE("vectors_that_depend_on_one_another_have_no_orthonormal_basis") {
  std::vector<double> two{3, 0, 0, 1, 1, 0}, alike{3, 0, 0, 1, 1e-9, 0}, none;
  CHECK(make_orthonormal(3, none));
  CHECK(make_orthonormal(3, two));
  CHECK(std::abs(two[0] * two[3] + two[1] * two[4] + two[2] * two[5]) < 1e-15);
  CHECK(!make_orthonormal(3, alike));
}

TEST_CASE("an_iteration_that_the_user_stops_has_not_broken_down") {
  constexpr std::size_t size = 500;
  const int last = GENERATE(1, 20, 60);
  int products = 0;
  const auto multiply = [&](std::span<const double> x, std::span<double> y) {
    if (++products > last) throw Error(ErrorKind::interrupted, "stopped as asked", "", "");
    for (std::size_t k = 0; k < x.size(); ++k) y[k] = static_cast<double>(k + 1) * x[k];
  };
  try {
    static_cast<void>(extreme_eigenvalue(size, multiply, SpectrumEnd::largest));
    FAIL("it went on");
  } catch (const Error& error) {
    CAPTURE(last, error.what());
    CHECK(error.kind() == ErrorKind::interrupted);
  }
}
