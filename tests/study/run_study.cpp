// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <memory>
#include <set>
#include <vector>

#include "equidem/core/error.hpp"
#include "equidem/core/random.hpp"
#include "equidem/core/stopwatch.hpp"
#include "equidem/study/evaluate.hpp"
#include "equidem/study/study.hpp"

#include "support/catch.hpp"

using namespace equidem;

namespace {

constexpr std::size_t settings = 6;

/// A study that writes down what it does.
Study recording(const std::shared_ptr<std::vector<std::size_t>>& log, std::size_t fails = settings) {
  Study study{.name = "recording", .title = "", .quantity = "error"};
  for (std::size_t k = 0; k < settings; ++k) {
    const double h = 1.0 / static_cast<double>(k + 1);
    study.tasks.push_back({{.values = {{"k", static_cast<double>(k)}}, .resolution = h}, [=] {
                             if (k == fails) bad_input("this setting is wrong", "", "");
                             return Trial{.work =
                                              [=] {
                                                log->push_back(k);
                                                const Stopwatch watch;
                                                while (watch.seconds() < 1.1e-3) {
                                                }
                                              },
                                          .value = [=] { return h; }};
                           }});
  }
  return study;
}

constexpr StudyOptions few{.budget = 0, .least_rounds = 3, .most_rounds = 3, .time_error = 0};

}  // namespace

TEST_CASE("every_round_goes_once_through_all_settings_in_an_order_drawn_anew") {
  const auto log = std::make_shared<std::vector<std::size_t>>();
  const StudySamples samples = run_study(recording(log), few);
  REQUIRE(log->size() == 4 * settings);  // one to warm up
  std::set<std::vector<std::size_t>> orders;
  for (std::size_t round = 0; round < 4; ++round) {
    const auto begin = log->begin() + static_cast<std::ptrdiff_t>(round * settings);
    const std::vector<std::size_t> order(begin, begin + settings);
    orders.insert(order);
    CHECK(std::set<std::size_t>(order.begin(), order.end()).size() == settings);
  }
  CHECK(orders.size() > 1);
  CHECK(samples.rounds() == 3);
  for (const TaskSamples& task : samples.tasks) CHECK(task.times.size() == 3);

  const auto again = std::make_shared<std::vector<std::size_t>>();
  run_study(recording(again), few);
  CHECK(*again == *log);
  const auto other = std::make_shared<std::vector<std::size_t>>();
  StudyOptions seeded = few;
  seeded.seed = 2;
  run_study(recording(other), seeded);
  CHECK(*other != *log);
}

TEST_CASE("a_study_goes_on_where_it_stopped") {
  const auto log = std::make_shared<std::vector<std::size_t>>();
  const Study study = recording(log);
  std::vector<StudySamples> saved;
  run_study(study, few, {}, [&](const StudySamples& done) { saved.push_back(done); });
  REQUIRE(saved.size() == log->size());
  const std::vector<std::size_t> whole = *log;
  for (const std::size_t stop : {std::size_t{2}, settings, settings + 3, whole.size() - 1}) {
    log->clear();
    const StudySamples rest = run_study(study, few, saved[stop - 1]);
    CAPTURE(stop);
    CHECK(*log == std::vector<std::size_t>(whole.begin() + static_cast<std::ptrdiff_t>(stop), whole.end()));
    CHECK(rest.rounds() == 3);
  }
}

TEST_CASE("a_setting_that_fails_keeps_its_reason_and_the_others_their_times") {
  const auto log = std::make_shared<std::vector<std::size_t>>();
  const Study study = recording(log, 2);
  const StudySamples samples = run_study(study, few);
  CHECK_THAT(samples.tasks[2].refusal, Catch::Contains("this setting is wrong"));
  CHECK(samples.rounds() == 3);
  const StudyResult result = evaluate(study, samples);
  CHECK(std::isnan(result.rows[2].error));
  CHECK(std::all_of(result.front.begin(), result.front.end(), [](std::size_t k) { return k != 2; }));
}

TEST_CASE("rounds_go_on_while_times_scatter_and_the_budget_lasts") {
  const auto log = std::make_shared<std::vector<std::size_t>>();
  StudyOptions options{.budget = 10, .least_rounds = 3, .most_rounds = 7, .time_error = 0};
  CHECK(run_study(recording(log), options).rounds() == 7);
  options.time_error = 1e9;
  CHECK(run_study(recording(log), options).rounds() == 3);
}

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
