// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/homogenize/calibrate/ratio_search.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "support/catch.hpp"

namespace {

using namespace equidem;

constexpr double tolerance = 1e-11;
constexpr double infinity = std::numeric_limits<double>::infinity();

/// q(r) with dq/dr, its limits, and the most steps that it may cost.
struct Curve {
  std::string name;
  std::function<double(double)> q, slope;
  double at_zero, at_infinity;
  int most_steps;
};

std::vector<Curve> curves() {
  return {
      {"hexagonal lattice, Abe 1996, eq. (34)", [](double r) { return (1 + r) / 2; }, [](double) { return 0.5; }, 0.5,
       infinity, 10},
      {"uniform-stress estimate (Liao et al. 1997)", [](double r) { return 2 * r / (1 + r); },
       [](double r) { return 2 / ((1 + r) * (1 + r)); }, 0, 2, 10},
      {"a network with one soft mode", [](double r) { return 0.4 + 0.3 * r + 0.5 * r / (r + 0.02); },
       [](double r) { return 0.3 + 0.5 * 0.02 / ((r + 0.02) * (r + 0.02)); }, 0.4, infinity, 11},
      {"modes at all scales: a square root between the ends",
       [](double r) { return 0.3 + 2 * std::sqrt(r) * r / (1 + std::sqrt(r) * r + 10 * std::sqrt(r)); },
       [](double r) {
         const double s = std::sqrt(r), D = 1 + s * r + 10 * s;
         return 2 * (1.5 * s * D - s * r * (1.5 * s + 5 / s)) / (D * D);
       },
       0.3, 2.3, 11},
  };
}

RatioSampler sampler(const Curve& curve, int& count) {
  return [&](double r) {
    ++count;
    return RatioSample{.ratio = r, .shear_to_bulk = curve.q(r), .slope = curve.slope(r)};
  };
}

TEST_CASE("curves_of_the_search_have_the_slopes_they_claim") {
  for (const Curve& curve : curves()) {
    for (const double r : {1e-3, 0.1, 1.0, 30.0}) {
      CAPTURE(curve.name, r);
      const double h = 1e-5 * r;
      CHECK((curve.q(r + h) - curve.q(r - h)) / (2 * h) == Approx(curve.slope(r)).epsilon(1e-6));
    }
  }
}

TEST_CASE("the_range_is_extrapolated_to_both_ends") {
  const std::vector<Curve> all = curves();
  for (std::size_t k = 0; k < 3; ++k) {  // the square root is at neither end yet
    CAPTURE(all[k].name);
    int count = 0;
    const RatioRange range = sample_range(sampler(all[k], count));
    CHECK(count == 2);
    CHECK(std::abs(range.at_zero - all[k].at_zero) < 1e-12);
    if (std::isfinite(all[k].at_infinity)) {
      CHECK(range.at_infinity == Approx(all[k].at_infinity).epsilon(1e-11));
    } else {
      CHECK(range.at_infinity == infinity);
    }
  }
}

TEST_CASE("the_wanted_ratio_of_moduli_is_found_in_few_samples") {
  for (const Curve& curve : curves()) {
    for (const double ratio : {1e-4, 1e-2, 0.1, 0.5, 1.0, 2.0, 10.0, 1e3}) {
      int count = 0;
      const RatioSampler sample = sampler(curve, count);
      const RatioRange range = sample_range(sample);
      const double wanted = curve.q(ratio);
      const FoundRatio found = find_ratio(sample, range, wanted, tolerance);
      CAPTURE(curve.name, ratio, wanted, found.at.ratio, found.steps);
      CHECK(found.reached);
      CHECK(found.rising);
      CHECK(std::abs(found.at.shear_to_bulk - wanted) <= tolerance * wanted);
      CHECK(std::abs(found.at.ratio - ratio) * curve.slope(ratio) <= 1.1 * tolerance * wanted);
      CHECK(found.steps <= curve.most_steps);
      CHECK(count == 2 + found.steps);
    }
  }
}

TEST_CASE("at_the_end_of_the_range_kT_is_0") {
  int count = 0;
  const Curve curve = curves().front();
  const RatioSampler sample = sampler(curve, count);
  const FoundRatio found = find_ratio(sample, sample_range(sample), 0.5, tolerance);
  CHECK(found.reached);
  CHECK(found.at.ratio == 0);
}

TEST_CASE("a_curve_that_does_not_rise_throughout_is_followed_and_said_so") {
  // Falls between r = 0.55 and r = 1.8.
  const Curve curve{"wave",
                    [](double r) { return 1 + r + std::sin(3 * std::log(1 + r)) * 0.9 * r; },
                    [](double r) {
                      return 1 +
                             0.9 * (std::sin(3 * std::log(1 + r)) + 3 * r / (1 + r) * std::cos(3 * std::log(1 + r)));
                    },
                    1,
                    infinity,
                    60};
  bool seen_falling = false;
  for (double wanted = 1.01; wanted < 6; wanted *= 1.1) {
    int count = 0;
    const RatioSampler sample = sampler(curve, count);
    const FoundRatio found = find_ratio(sample, sample_range(sample), wanted, tolerance);
    CAPTURE(wanted, found.at.ratio, found.steps);
    CHECK(found.reached);
    CHECK(std::abs(curve.q(found.at.ratio) - wanted) <= 2 * tolerance * wanted);
    seen_falling = seen_falling || !found.rising;
  }
  CHECK(seen_falling);
}

/// A sum of r/(r + t) with positive weights, as K and G of a network.
struct PositiveSum {
  double at_zero;
  std::vector<std::pair<double, double>> terms;  ///< weight, t

  double value(double r) const {
    double sum = at_zero;
    for (const auto& [weight, t] : terms) sum += weight * r / (r + t);
    return sum;
  }
  double slope(double r) const {
    double sum = 0;
    for (const auto& [weight, t] : terms) sum += weight * t / ((r + t) * (r + t));
    return sum;
  }
};

struct Network {
  std::string name;
  PositiveSum G, K;
  double lost_below = 0;  ///< r at which stability is lost

  double q(double r) const { return G.value(r) / K.value(r); }
  RatioSample at(double r) const {
    const double g = G.value(r), k = K.value(r);
    return {.ratio = r,
            .shear_to_bulk = g / k,
            .slope = (G.slope(r) * k - g * K.slope(r)) / (k * k),
            .bulk_growth = r * K.slope(r) / k,
            .stable = r >= lost_below};
  }
};

std::vector<Network> networks() {
  return {
      {"q falls, then rises", {0.1, {{0.2, 0.1}, {0.5, 3}}}, {0.09, {{0.35, 0.02}, {0.1, 1}}}},
      {"q falls from end to end", {0.3, {{0.2, 1}}}, {0.2, {{0.5, 0.5}}}},
      {"rises, falls, rises", {0.1, {{0.2, 1e-5}, {1, 5}}}, {0.2, {{0.5, 1e-3}}}},
      {"a mechanism at r = 0", {0, {{0.1, 1e-3}, {0.4, 3}}}, {0, {{0.3, 0.02}, {0.2, 1}}}},
      {"a mechanism lost in rounding", {0, {{0.1, 1e-3}, {0.4, 3}}}, {0, {{0.3, 0.02}, {0.2, 1}}}, 1e-5},
  };
}

TEST_CASE("a_scan_finds_the_extremes_and_what_lies_between_them") {
  for (const Network& network : networks()) {
    const RatioSampler sample = [&](double r) { return network.at(r); };
    RatioRange range = sample_range(sample);
    CAPTURE(network.name, range.smallest.ratio, range.closed);
    REQUIRE(range.smallest.stable);
    CHECK(range.smallest.ratio >= network.lost_below);
    find_by_scan(sample, range, -1, tolerance);
    double least = infinity, greatest = 0;
    for (double x = std::log(range.smallest.ratio); x < std::log(1e6); x += 1e-3) {
      least = std::min(least, network.q(std::exp(x)));
      greatest = std::max(greatest, network.q(std::exp(x)));
    }
    CHECK(range.least == Approx(least).epsilon(1e-6));
    CHECK(range.greatest == Approx(greatest).epsilon(1e-6));
    for (const double part : {1e-6, 0.01, 0.3, 0.7, 0.99, 1 - 1e-6}) {
      const double wanted = least + part * (greatest - least);
      const FoundRatio found = find_by_scan(sample, range, wanted, tolerance);
      CAPTURE(part, wanted, found.at.ratio, found.steps);
      CHECK(found.reached);
      CHECK(network.q(found.at.ratio) == Approx(wanted).epsilon(2 * tolerance));
      CHECK(found.steps < 50);
    }
    CHECK_FALSE(find_by_scan(sample, range, 1.001 * greatest, tolerance).reached);
    CHECK_FALSE(find_by_scan(sample, range, 0.999 * least, tolerance).reached);
  }
}

TEST_CASE("a_network_that_always_gives_way_has_no_range") {
  const RatioRange range = sample_range([](double r) { return RatioSample{.ratio = r, .stable = false}; });
  CHECK_FALSE(range.smallest.stable);
}

TEST_CASE("a_jump_is_not_taken_for_an_answer") {
  const RatioSampler jumping = [](double r) {
    return RatioSample{
        .ratio = r, .shear_to_bulk = (r < 1 ? 1 : 2) + 0.1 * r / (1 + r), .slope = 0.1 / ((1 + r) * (1 + r))};
  };
  CHECK_THROWS_WITH(find_ratio(jumping, sample_range(jumping), 1.5, tolerance), Catch::Contains("was not reached"));
}

/// q = (1 + r)/2 + bend r²: stable above `limit` only.
RatioSampler unstable_below(double limit, double bend = 0) {
  return [=](double r) {
    if (r <= limit) return RatioSample{.ratio = r, .shear_to_bulk = 77, .slope = -77, .stable = false};
    return RatioSample{.ratio = r, .shear_to_bulk = (1 + r) / 2 + bend * r * r, .slope = 0.5 + 2 * bend * r};
  };
}

TEST_CASE("negative_ratios_are_found_where_the_assembly_stands") {
  for (const double bend : {0.0, 0.3, -0.3}) {
    const RatioSampler sample = unstable_below(-1.0 / 3, bend);
    const RatioRange range = sample_range(sample);
    for (const double ratio : {-1e-6, -0.01, -0.2, -0.3333}) {
      const FoundRatio found = find_negative_ratio(sample, range, (1 + ratio) / 2 + bend * ratio * ratio, tolerance);
      CAPTURE(bend, ratio, found.at.ratio, found.steps);
      CHECK(found.reached);
      CHECK(found.at.ratio == Approx(ratio).epsilon(1e-9).margin(1e-10));
    }
  }
}

TEST_CASE("beyond_the_static_limit_the_last_stable_ratio_is_given") {
  for (const double limit : {-1.0 / 3, -0.02}) {
    const RatioSampler sample = unstable_below(limit);
    const FoundRatio found = find_negative_ratio(sample, sample_range(sample), 0.2, tolerance);
    CAPTURE(limit, found.at.ratio, found.steps);
    CHECK_FALSE(found.reached);
    CHECK(found.at.stable);
    CHECK(found.at.ratio > limit);
    CHECK(found.at.ratio < 0.998 * limit);
  }
  SECTION("which is none where nothing negative is stable") {
    const RatioSampler sample = unstable_below(0);
    const FoundRatio found = find_negative_ratio(sample, sample_range(sample), 0.2, tolerance);
    CHECK_FALSE(found.reached);
    CHECK(found.at.ratio > 0);
    CHECK(found.steps < 20);
  }
}

}  // namespace
