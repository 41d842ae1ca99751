// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The accuracy asked of a refinement is kept, at little more than the least cost, on problems with a closed form.
#include "equidem/study/refinement.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <tuple>
#include <vector>

#include "equidem/assembly/lattices.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/random.hpp"
#include "equidem/homogenize/tension_test.hpp"
#include "equidem/material/spring_relations.hpp"

#include "support/catch.hpp"

using namespace equidem;

namespace {

constexpr double radius = 0.005, kN = 1e9;

/// (35) and the logarithm of (36) on a block of rows x rows.
std::vector<double> tension_of(std::int64_t rows, double ratio, GaugePlacement gauge) {
  const auto n = static_cast<int>(rows);
  const Assembly block = hexagonal_lattice({.columns = n, .rows = n, .radius = radius});
  const ContactSprings springs(SpringConstants{kN, ratio * kN});
  const TensionTest test{.gauge = gauge};
  const TensionSetup setup = tension_setup(block, test);
  const Equilibrium rest = solve_equilibrium(block, springs, setup.supports, setup.loads);
  const TensionResult result = evaluate_tension(block, springs, test, setup, rest);
  return {result.poisson_ratio, std::log(result.stiffness_ratio)};
}

std::int64_t one_beyond_a_multiple_of_four(std::int64_t n) {
  return n + (5 - n % 4) % 4;
}

double largest(const std::vector<double>& a, const std::vector<double>& b) {
  double far = 0;
  for (std::size_t k = 0; k < a.size(); ++k) far = std::max(far, std::abs(a[k] - b[k]));
  return far;
}

}  // namespace

TEST_CASE("accuracy_asked_of_abes_test_is_kept_at_most_twice_the_least_cost") {
  std::map<std::tuple<std::int64_t, double, int>, std::vector<double>> known;
  Random random(3);
  constexpr int requests = 200;
  int kept = 0, cheap = 0;
  double dearest = 0;
  std::vector<double> dear;
  for (int k = 0; k < requests; ++k) {
    const double ratio = 0.3 * static_cast<double>(1 + random.below(3));
    const GaugePlacement gauge = std::vector{GaugePlacement::centre, GaugePlacement::quarter,
                                             GaugePlacement::ends}[static_cast<std::size_t>(random.below(3))];
    const double accuracy = 4e-3 * std::pow(8.0, random.uniform());
    const auto evaluate = [&](std::int64_t rows) {
      const std::tuple key(rows, ratio, static_cast<int>(gauge));
      if (!known.contains(key)) known[key] = tension_of(rows, ratio, gauge);
      return known[key];
    };
    const Refinement got = refine_to(
        evaluate,
        {.accuracy = accuracy, .order = 1, .first = 9, .most = 129, .admissible = one_beyond_a_multiple_of_four});
    const std::vector<double> truth{poisson_ratio_of_ratio(ratio), std::log(hexagonal_stiffness_ratio(ratio))};
    kept += largest(got.values, truth) <= accuracy ? 1 : 0;
    // The least: the largest block that does not do, and one row of gauges more.
    std::int64_t least = got.level;
    while (least > 9 && largest(evaluate(least - 4), truth) <= accuracy) least -= 4;
    const double dearer = std::pow(static_cast<double>(got.level) / static_cast<double>(least), 2.2);
    cheap += dearer <= 2 ? 1 : 0;
    dearest = std::max(dearest, dearer);
  }
  CAPTURE(kept, cheap, requests, dearest);
  CHECK(kept >= 0.95 * requests);
  CHECK(cheap >= 0.95 * requests);
}

TEST_CASE("accuracy_asked_of_an_oscillator_is_kept_at_most_twice_the_least_cost") {
  // Leapfrog on x'' = -w^2 x over a time of 1 from x = 1 at rest: x_n = cos(2 n asin(w h/2)) (its own closed form differs from the truth,
  // cos w, by second order).
  Random random(5);
  constexpr int requests = 200;
  int kept = 0, cheap = 0;
  for (int k = 0; k < requests; ++k) {
    const double w = random.uniform(1, 40), accuracy = std::pow(10.0, random.uniform(-6, -1.5));
    const auto evaluate = [&](std::int64_t n) {
      const double angle = 2 * static_cast<double>(n) * std::asin(0.5 * w / static_cast<double>(n));
      return std::vector{std::cos(angle), std::sin(angle)};
    };
    const std::vector<double> truth{std::cos(w), std::sin(w)};
    const auto first = static_cast<std::int64_t>(std::ceil(w / 1.6));
    const Refinement got = refine_to(evaluate, {.accuracy = accuracy, .order = 2, .first = first, .most = 10000000});
    kept += largest(got.values, truth) <= accuracy ? 1 : 0;
    const std::int64_t half = got.level / 2;
    cheap += half < first || largest(evaluate(half), truth) > accuracy ? 1 : 0;
  }
  CAPTURE(kept, cheap, requests);
  CHECK(kept >= 0.95 * requests);
  CHECK(cheap >= 0.95 * requests);
}

TEST_CASE("accuracy_that_no_level_reaches_is_refused_with_what_can_be_reached") {
  const auto refused = [](const std::function<std::vector<double>(std::int64_t)>& evaluate, const char* words) {
    try {
      refine_to(evaluate, {.accuracy = 1e-6, .order = 1, .first = 8, .most = 1000});
      FAIL("reached");
    } catch (const Error& error) {
      CHECK(error.kind() == ErrorKind::computation_failed);
      CHECK_THAT(error.what(), Catch::Contains("cannot be reached") && Catch::Contains(words));
    }
  };
  SECTION("too fine") {
    refused([](std::int64_t n) { return std::vector{1 + 1.0 / static_cast<double>(n)}; }, "about 0.001");
  }
  SECTION("errors that do not fall") {
    refused([](std::int64_t n) { return std::vector{n % 3 == 0 ? 1.0 : 2.0 + static_cast<double>(n % 7)}; },
            "and not as level^-1");
  }
}
