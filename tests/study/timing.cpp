// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <vector>

#include "equidem/core/random.hpp"
#include "equidem/core/stopwatch.hpp"
#include "equidem/study/run_study.hpp"

#include "support/catch.hpp"

using namespace equidem;

TEST_CASE("quantiles_lie_between_their_order_statistics") {
  const std::vector<double> sorted{1, 2, 4, 8, 16};
  CHECK(quantile(sorted, 0) == 1);
  CHECK(quantile(sorted, 0.25) == 2);
  CHECK(quantile(sorted, 0.5) == 4);
  CHECK(quantile(sorted, 0.625) == Approx(6));
  CHECK(quantile(sorted, 1) == 16);
}

TEST_CASE("a_disturbance_leaves_the_median_where_it_is") {
  std::vector<TimeSample> samples;
  for (int k = 0; k < 9; ++k) samples.push_back({1 + 0.001 * k, 1});
  const Timing calm = summarize(samples);
  samples[8] = {1000, 1};
  const Timing disturbed = summarize(samples);
  CHECK(disturbed.median == calm.median);
  CHECK(disturbed.relative_error() == calm.relative_error());
  CHECK(calm.repetitions == 9);
  CHECK(std::isinf(summarize(std::vector<TimeSample>(2, TimeSample{1, 1})).relative_error()));
}

TEST_CASE("the_error_of_the_median_is_that_of_many_samples") {
  Random random(1);
  constexpr int samples = 25, tries = 2000;
  double sum = 0, squares = 0, said = 0;
  for (int k = 0; k < tries; ++k) {
    std::vector<TimeSample> times;
    for (int n = 0; n < samples; ++n) {
      double noise = -6;
      for (int m = 0; m < 12; ++m) noise += random.uniform();
      times.push_back({10 + 0.5 * noise, 0});
    }
    const Timing timing = summarize(times);
    sum += timing.median / tries;
    squares += timing.median * timing.median / tries;
    said += timing.relative_error() * timing.median / tries;
  }
  const double measured = std::sqrt(squares - sum * sum);
  CAPTURE(measured, said);
  CHECK(said == Approx(measured).epsilon(0.1));
}

TEST_CASE("short_work_is_done_until_the_clock_can_see_it_each_time_on_fresh_ground") {
  int prepared = 0, done = 0;
  const TimeSample sample = time_work(
      [&] {
        ++prepared;
        return [&] {
          ++done;
          const Stopwatch watch;
          while (watch.seconds() < 1e-4) {
          }
        };
      },
      2e-3);
  CAPTURE(prepared, sample.seconds, sample.processor_seconds);
  CHECK(prepared == done);
  CHECK(done >= 2);
  CHECK(sample.seconds >= 1e-4);
  CHECK(sample.seconds * done >= 2e-3);
}

TEST_CASE("preparation_is_not_timed") {
  const TimeSample sample = time_work(
      [] {
        const Stopwatch watch;
        while (watch.seconds() < 5e-3) {
        }
        return [] {};
      },
      0);
  CAPTURE(sample.seconds, sample.processor_seconds);
  CHECK(sample.processor_seconds < 2e-3);  // a busy machine makes others wait, which no processor time counts
}
