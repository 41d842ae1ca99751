// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/fields/spectrum.hpp"

#include <cmath>
#include <numbers>
#include <vector>

#include "equidem/core/error.hpp"

#include "support/catch.hpp"

using namespace equidem;

namespace {

constexpr double pi = std::numbers::pi;

struct History {
  std::vector<double> times, values;
  template <typename Value>
  History(double duration, int moments, const Value& value) {
    for (int k = 0; k < moments; ++k) {
      times.push_back(3 + duration * k / (moments - 1));
      values.push_back(value(times.back()));
    }
  }
};

}  // namespace

TEST_CASE("the_peaks_of_two_sines_are_found_though_a_mean_and_a_trend_are_larger") {
  const double duration = 20;
  for (const double stronger : {0.8, 1.15}) {
    const double weaker = stronger == 0.8 ? 1.15 : 0.8;  // 7 over the duration apart
    const History h(duration, 801, [&](double t) {
      return 50 + 0.7 * t + 2 * std::sin(2 * pi * stronger * t + 1) + 0.5 * std::cos(2 * pi * weaker * t);
    });
    const SpectralPeak peak = spectral_peak(h.times, h.values, 0.1, 5);
    CAPTURE(stronger, peak.frequency, peak.amplitude);
    CHECK(peak.resolution == Approx(2 / duration));
    CHECK(peak.frequency == Approx(stronger).margin(0.02 / duration));
    CHECK(peak.amplitude == Approx(2).epsilon(0.01));
    const SpectralPeak other = spectral_peak(h.times, h.values, weaker - 2 / duration, weaker + 2 / duration);
    CHECK(other.frequency == Approx(weaker).margin(0.1 / duration));
    CHECK(other.amplitude == Approx(0.5).epsilon(0.05));
  }
}

TEST_CASE("a_single_sine_is_exact_even_over_two_periods_and_with_moments_out_of_step") {
  const double f = 0.213;
  const History even(2.2 / f, 60, [&](double t) { return 4 - t + 0.1 * std::sin(2 * pi * f * t); });
  History uneven = even;
  for (std::size_t k = 1; k + 1 < uneven.times.size(); ++k) {
    uneven.times[k] += 0.03 * std::sin(7.0 * static_cast<double>(k));
    uneven.values[k] = 4 - uneven.times[k] + 0.1 * std::sin(2 * pi * f * uneven.times[k]);
  }
  for (const History* h : {&even, static_cast<const History*>(&uneven)}) {
    const SpectralPeak peak = spectral_peak(h->times, h->values, 0, 1);
    CHECK(peak.frequency == Approx(f).epsilon(1e-6));
    CHECK(peak.amplitude == Approx(0.1).epsilon(1e-6));
  }
}

TEST_CASE("histories_without_a_period_are_refused") {
  const History constant(10, 100, [](double) { return 3.0; }), few(10, 5, [](double t) { return t; });
  const History sine(10, 100, [](double t) { return std::sin(2 * pi * t); });
  CHECK_THROWS_AS(spectral_peak(constant.times, constant.values, 0, 10), Error);
  CHECK_THROWS_AS(spectral_peak(few.times, few.values, 0, 10), Error);
  CHECK_THROWS_AS(spectral_peak(sine.times, sine.values, 6, 7), Error);       // beyond half the rate
  CHECK_THROWS_AS(spectral_peak(sine.times, sine.values, 0.5, 0.95), Error);  // only the flank of the peak lies there
  CHECK(spectral_peak(sine.times, sine.values, 0.5, 2).frequency == Approx(1));
}

TEST_CASE("sloshing_periods_of_the_thesis_and_of_both_limits") {
  CHECK(sloshing_period(1.215, 2.25, 9.80665) == Approx(1.2482).margin(1.5e-3));
  CHECK(sloshing_period(1.215, 2.25, 9.8) == Approx(1.2482).margin(5e-5));
  CHECK(sloshing_period(1.215, 0.549, 9.8) == Approx(1.3235).margin(1e-4));
  // Shallow: a long wave over twice the width; deep: no depth left in it.
  CHECK(sloshing_period(2, 1e-4, 9.81) == Approx(4 / std::sqrt(9.81e-4)).epsilon(1e-6));
  CHECK(sloshing_period(2, 100, 9.81) == Approx(2 * std::sqrt(pi * 2 / 9.81)).epsilon(1e-12));
}
