// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/study/evaluate.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "equidem/core/random.hpp"

#include "support/catch.hpp"
#include "support/requests.hpp"

using namespace equidem;

namespace {

/// Measurements as given, h = 2^-k.
struct Given {
  Study study{.name = "given", .title = "", .quantity = "f"};
  StudySamples samples;

  void add(const std::string& method, double h, double value, double seconds, std::optional<double> order = {}) {
    study.tasks.push_back({{.method = method, .values = {{"h", h}}, .resolution = h, .order = order}, {}});
    samples.tasks.push_back({.value = value, .times = std::vector<TimeSample>(3, TimeSample{seconds, seconds})});
  }
};

/// f = 1 + h^order, time 1/h.
Given converging(double order, Truth truth, double theory) {
  Given given;
  given.study.truth = truth;
  given.study.true_value = 1;
  for (int k = 0; k < 8; ++k) {
    const double h = std::pow(2.0, -k);
    given.add("", h, 1 + std::pow(h, order), 1 / h, theory);
  }
  return given;
}

bool beats(const CostPoint& a, const CostPoint& b) {
  return a.seconds <= b.seconds && a.error <= b.error && (a.seconds < b.seconds || a.error < b.error);
}

std::vector<CostPoint> random_points(std::uint64_t seed, int count) {
  Random random(seed);
  std::vector<CostPoint> points;
  // few different values, so that ties are frequent
  for (int k = 0; k < count; ++k)
    points.push_back({static_cast<double>(random.below(10)), static_cast<double>(random.below(10))});
  return points;
}

std::vector<Level> levels(int count, const std::function<double(double)>& error) {
  std::vector<Level> all;
  for (int k = 0; k < count; ++k) {
    const double h = std::pow(2.0, -k);
    all.push_back({h, error(h)});
  }
  return all;
}

}  // namespace

TEST_CASE("errors_refer_to_the_truth_that_is_asked_for") {
  const double order = GENERATE(1.0, 2.0);
  for (const Truth truth : {Truth::known, Truth::richardson}) {
    const Given given = converging(order, truth, order);
    const StudyResult result = evaluate(given.study, given.samples);
    for (const StudyRow& row : result.rows)
      CHECK(row.error == Approx(std::pow(row.setting.resolution, order)).epsilon(1e-9));
    REQUIRE(result.curves.size() == 1);
    CHECK(result.curves[0].order->order == Approx(order).epsilon(1e-6));
    CHECK(result.curves[0].cost_exponent == Approx(1).epsilon(1e-9));
    CHECK(result.curves[0].agrees);
  }
  const Given given = converging(order, Truth::finest, order);
  const StudyResult result = evaluate(given.study, given.samples);
  CHECK(std::isnan(result.rows.back().error));
  CHECK(result.rows[0].error == Approx(1 - std::pow(2.0, -7 * order)));
}

TEST_CASE("an_order_that_is_not_that_of_theory_is_told") {
  const Given given = converging(1, Truth::known, 2);
  CHECK_FALSE(evaluate(given.study, given.samples).curves[0].agrees);
}

TEST_CASE("an_error_small_by_luck_does_not_make_a_setting_good") {
  Given given;
  given.add("", 1, 0.1, 1);
  given.add("", 0.5, 1e-9, 2);  // the error changes its sign here
  given.add("", 0.25, 0.02, 4);
  given.add("", 0.125, 0.01, 8);
  const StudyResult result = evaluate(given.study, given.samples);
  CHECK(result.rows[1].error == 1e-9);
  CHECK(result.rows[1].assured == 0.02);
  CHECK(recommend(result, 0.015)->row == std::size_t{3});
  CHECK_FALSE(recommend(result, 1e-3)->row);
  CHECK_THAT(recommend(result, 1e-3)->text, Catch::Contains("no setting reaches 0.001"));
}

TEST_CASE("what_is_recommended_keeps_its_accuracy_and_costs_at_most_twice_the_cheapest") {
  Random random(1);
  int kept = 0, cheap = 0;
  constexpr int requests = 200;
  for (int request = 0; request < requests; ++request) {
    Given given;
    for (const char* method : {"a", "b", "c"}) {
      const double order = random.uniform(0.5, 4), constant = random.uniform(0.1, 10), cost = random.uniform(1, 3);
      const double rate = std::exp(random.uniform(-3, 3));
      for (int k = 0; k < 10; ++k) {
        const double h = std::pow(2.0, -k);
        given.add(method, h, constant * std::pow(h, order) * random.uniform(0.8, 1.2), rate * std::pow(h, -cost));
      }
    }
    const StudyResult result = evaluate(given.study, given.samples);
    const double wanted = std::pow(10, random.uniform(-4, -1));
    const auto chosen = recommend(result, wanted)->row;
    double least = INFINITY;
    for (const StudyRow& row : result.rows) {
      if (row.error <= wanted) least = std::min(least, row.time.median);
    }
    REQUIRE(chosen.has_value() == std::isfinite(least));
    if (!chosen) continue;
    kept += result.rows[*chosen].error <= wanted ? 1 : 0;
    cheap += result.rows[*chosen].time.median <= 2 * least ? 1 : 0;
  }
  CAPTURE(kept, cheap);
  CHECK(kept >= 0.95 * requests);
  CHECK(cheap >= 0.95 * requests);
  write_down({.task = "equidem study: invented errors and times of three methods",
              .requests = requests,
              .kept = kept,
              .cheap = cheap});
}

TEST_CASE("the_checksum_tells_studies_apart") {
  const Given given = converging(1, Truth::known, 1);
  Given other = converging(1, Truth::known, 1);
  CHECK(given.study.checksum("here") == other.study.checksum("here"));
  CHECK(given.study.checksum("here") != given.study.checksum("there"));
  other.study.tasks[3].setting.values[0].second += 1e-15;
  CHECK(given.study.checksum("here") != other.study.checksum("here"));
}

TEST_CASE("the_front_holds_what_nothing_beats_and_nothing_else") {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    const std::vector<CostPoint> points = random_points(seed, 30);
    const std::vector<std::size_t> front = front_of(points);
    CAPTURE(seed, front);
    for (std::size_t k = 0; k < points.size(); ++k) {
      const bool beaten =
          std::any_of(points.begin(), points.end(), [&](const CostPoint& p) { return beats(p, points[k]); });
      const bool on_front = std::any_of(front.begin(), front.end(), [&](std::size_t f) {
        return points[f].seconds == points[k].seconds && points[f].error == points[k].error;
      });
      CHECK(on_front == !beaten);
    }
    for (std::size_t k = 1; k < front.size(); ++k) {
      CHECK(points[front[k]].seconds > points[front[k - 1]].seconds);
      CHECK(points[front[k]].error < points[front[k - 1]].error);
    }
  }
}

TEST_CASE("the_cheapest_setting_is_the_one_that_a_search_of_all_finds") {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const std::vector<CostPoint> points = random_points(seed, 12);
    for (double wanted = -0.5; wanted < 10; wanted += 1) {
      double least = 1e300;
      for (const CostPoint& point : points) {
        if (point.error <= wanted) least = std::min(least, point.seconds);
      }
      const auto found = cheapest_within(points, wanted);
      CAPTURE(seed, wanted, least);
      REQUIRE(found.has_value() == (least < 1e300));
      if (found) CHECK((points[*found].seconds == least && points[*found].error <= wanted));
    }
  }
}

TEST_CASE("what_has_no_error_takes_no_part") {
  const std::vector<CostPoint> points{{1, NAN}, {2, 0.5}, {NAN, 0.1}};
  CHECK(front_of(points) == std::vector<std::size_t>{1});
}

TEST_CASE("powers_of_the_resolution_have_their_exponent_as_order") {
  const double p = GENERATE(0.5, 1.0, 2.0, 4.0);
  const auto order = observed_order(levels(6, [&](double h) { return 3 * std::pow(h, p); }));
  REQUIRE(order);
  CHECK(order->order == Approx(p).epsilon(1e-12));
  CHECK(order->uncertainty < 1e-10);
  CHECK(order->constant == Approx(3).epsilon(1e-12));
  CHECK(order->error_at(0.01) == Approx(3 * std::pow(0.01, p)).epsilon(1e-12));
}

TEST_CASE("coarse_levels_before_the_asymptotic_range_do_not_spoil_the_order") {
  const auto order = observed_order(levels(10, [](double h) { return h * h / (1 + 50 * h * h * h); }));
  REQUIRE(order);
  CAPTURE(order->order, order->uncertainty, order->levels, order->coarsest);
  CHECK(order->order == Approx(2).margin(0.05));
  CHECK(order->coarsest < 0.3);
}

TEST_CASE("errors_at_the_floor_of_rounding_are_no_part_of_the_order") {
  const auto all = levels(12, [](double h) { return std::max(std::pow(h, 4), 1e-9); });
  const auto order = observed_order(all, 1e-9);
  REQUIRE(order);
  CHECK(order->order == Approx(4).epsilon(1e-9));
  CHECK(order->finest > 0.005);
  CHECK(std::abs(observed_order(all)->order - 4) > 0.5);  // they would be
}

TEST_CASE("the_interval_of_the_order_holds_the_true_one_as_often_as_it_says") {
  Random random(1);
  int held = 0;
  constexpr int tries = 400;
  for (int k = 0; k < tries; ++k) {
    // three levels: no choice of a range, so that the interval is Student's
    const auto order = observed_order(levels(3, [&](double h) {
      double noise = -6;  // nearly normal (sum of twelve)
      for (int n = 0; n < 12; ++n) noise += random.uniform();
      return std::pow(h, 1.5) * std::exp(0.1 * noise);
    }));
    held += std::abs(order->order - 1.5) <= order->uncertainty ? 1 : 0;
  }
  CAPTURE(held);
  CHECK(std::abs(held - 0.95 * tries) < 4 * std::sqrt(tries * 0.95 * 0.05));
}

TEST_CASE("no_order_is_read_off_less_than_two_levels") {
  CHECK_FALSE(observed_order(std::vector<Level>{}));
  CHECK_FALSE(observed_order(std::vector<Level>{{1, 0.1}}));
  CHECK_FALSE(observed_order(std::vector<Level>{{1, 0.1}, {1, 0.2}}));
  CHECK_FALSE(observed_order(std::vector<Level>{{1, 0.1}, {0.5, 0}, {0.25, NAN}}));
  CHECK(std::isnan(observed_order(std::vector<Level>{{1, 0.1}, {0.5, 0.05}})->uncertainty));
}

TEST_CASE("richardson_is_exact_for_one_power") {
  for (const double p : {0.5, 1.0, 2.0, 3.7}) {
    const auto f = [&](double h) { return 7 - 2 * std::pow(h, p); };
    const std::array h{0.5, 0.3, 0.1};
    const std::array values{f(h[0]), f(h[1]), f(h[2])};
    CHECK(richardson_limit(h[1], values[1], h[2], values[2], p) == Approx(7).epsilon(1e-13));
    const auto order = order_of_three(h, values);
    REQUIRE(order);
    CHECK(*order == Approx(p).epsilon(1e-9));
  }
  CHECK_FALSE(order_of_three(std::array{0.5, 0.3, 0.1}, std::array{1.0, 2.0, 1.5}));  // it sways
}

TEST_CASE("ten_times_the_accuracy_costs_ten_to_the_cost_over_the_order") {
  CHECK(cost_of_accuracy(10, 2, 1) == Approx(100));
  CHECK(cost_of_accuracy(10, 1, 4) == Approx(std::pow(10, 0.25)));
}
