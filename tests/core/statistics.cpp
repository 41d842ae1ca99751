// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Confidence intervals hold the true value as often as they state.
#include "equidem/core/statistics.hpp"

#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "equidem/core/random.hpp"

#include "support/catch.hpp"

using namespace equidem;

namespace {

/// Box & Muller (1958).
double draw_normal(Random& random) {
  const double radius = std::sqrt(-2 * std::log(1 - random.uniform()));
  return radius * std::cos(2 * std::numbers::pi * random.uniform());
}

/// A share that is `expected` on average, of `trials` trials: within four standard deviations.
void check_share(std::int64_t successes, std::int64_t trials, double expected) {
  const double share = static_cast<double>(successes) / static_cast<double>(trials);
  const double deviation = std::sqrt(expected * (1 - expected) / static_cast<double>(trials));
  CAPTURE(trials, share, expected, deviation);
  CHECK(std::abs(share - expected) < 4 * deviation);
}

}  // namespace

TEST_CASE("critical_values_of_students_t_are_those_of_the_tables") {
  // Abramowitz & Stegun (1964), table 26.10.
  struct Entry {
    double confidence;
    std::int64_t degrees_of_freedom;
    double value;
  };
  for (const Entry& e : {Entry{0.95, 1, 12.706}, Entry{0.95, 2, 4.303}, Entry{0.95, 5, 2.571}, Entry{0.95, 9, 2.262},
                         Entry{0.95, 30, 2.042}, Entry{0.95, 120, 1.980}, Entry{0.99, 1, 63.657},
                         Entry{0.99, 10, 3.169}, Entry{0.9, 4, 2.132}, Entry{0.95, 1000000, 1.960}}) {
    const double t = student_critical_value(e.confidence, e.degrees_of_freedom);
    CAPTURE(e.confidence, e.degrees_of_freedom, e.value, t);
    CHECK(std::abs(t - e.value) < 0.00051);
  }
}

TEST_CASE("mean_and_standard_deviation_are_the_textbooks") {
  const MeanEstimate e = estimate_mean(std::vector<double>{1, 2, 3, 6}, 0.95);
  CHECK(e.samples == 4);
  CHECK(e.mean == Approx(3).epsilon(1e-15));
  CHECK(e.standard_deviation == Approx(std::sqrt(14.0 / 3)).epsilon(1e-15));
  CHECK(e.standard_error == Approx(std::sqrt(14.0 / 12)).epsilon(1e-15));
  CHECK(e.low() < e.mean);
  CHECK(e.high() - e.mean == Approx(e.mean - e.low()));
}

TEST_CASE("samples_do_not_tell_more_than_they_can") {
  const MeanEstimate none = estimate_mean({}, 0.95);
  CHECK(std::isnan(none.mean));
  const MeanEstimate one = estimate_mean(std::vector<double>{7}, 0.95);
  CHECK(one.mean == 7);
  CHECK(std::isnan(one.standard_deviation));
  CHECK(std::isnan(one.half_width));
}

TEST_CASE("the_confidence_interval_covers_the_true_mean_as_often_as_stated") {
  const int samples = GENERATE(2, 3, 5, 20);
  const double confidence = GENERATE(0.68, 0.95);
  constexpr double truth = 3, deviation = 2;
  constexpr int trials = 4000;
  Random random(static_cast<std::uint64_t>(17 + samples));
  std::int64_t covered = 0;
  for (int trial = 0; trial < trials; ++trial) {
    std::vector<double> values;
    for (int k = 0; k < samples; ++k) values.push_back(truth + deviation * draw_normal(random));
    const MeanEstimate e = estimate_mean(values, confidence);
    if (e.low() <= truth && truth <= e.high()) ++covered;
  }
  CAPTURE(samples);
  check_share(covered, trials, confidence);
}

TEST_CASE("a_line_is_recovered_from_points_on_it") {
  const std::vector<double> x{1, 2, 5, 7}, errors{0.1, 3, 0.2, 1};
  std::vector<double> y;
  for (const double value : x) y.push_back(4 - 0.5 * value);
  const LineFit fit = fit_line(x, y, errors);
  CHECK(fit.intercept == Approx(4).epsilon(1e-13));
  CHECK(fit.slope == Approx(-0.5).epsilon(1e-13));
}

TEST_CASE("intercept_and_slope_of_a_fit_lie_within_their_standard_errors_as_often_as_a_normal_distribution_says") {
  const std::vector<double> x{0.01, 0.02, 0.1, 0.4}, errors{0.5, 0.1, 0.2, 0.05};
  constexpr double intercept = 2, slope = -3;
  constexpr int trials = 4000;
  Random random(5);
  std::int64_t intercepts = 0, slopes = 0;
  for (int trial = 0; trial < trials; ++trial) {
    std::vector<double> y;
    for (std::size_t k = 0; k < x.size(); ++k) y.push_back(intercept + slope * x[k] + errors[k] * draw_normal(random));
    const LineFit fit = fit_line(x, y, errors);
    if (std::abs(fit.intercept - intercept) <= fit.intercept_error) ++intercepts;
    if (std::abs(fit.slope - slope) <= fit.slope_error) ++slopes;
  }
  const double within_one = std::erf(std::sqrt(0.5));
  check_share(intercepts, trials, within_one);
  check_share(slopes, trials, within_one);
}
