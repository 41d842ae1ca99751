// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/study/evaluate.hpp"

#include <cmath>
#include <vector>

#include "equidem/core/random.hpp"

#include "support/catch.hpp"
#include "support/requests.hpp"

using namespace equidem;

namespace {

/// Measurements as given: one quantity, h = 2^-k.
struct Given {
  Study study{.name = "given", .title = "", .quantities = {{.name = "f"}}, .tasks = {}};
  StudySamples samples;

  void add(const std::string& problem, const std::string& method, double h, double value, double seconds) {
    study.tasks.push_back({{.problem = problem, .method = method, .values = {{"h", h}}, .resolution = h}, {}});
    samples.tasks.push_back({{value}, "", std::vector<TimeSample>(3, TimeSample{seconds, seconds})});
  }
};

/// f = 1 + h^order, time 1/h.
Given converging(double order, Truth truth) {
  Given given;
  given.study.truth = truth;
  given.study.quantities[0].truth = 1;
  given.study.orders = {{.order = order}};
  for (int k = 0; k < 8; ++k) {
    const double h = std::pow(2.0, -k);
    given.add("", "", h, 1 + std::pow(h, order), 1 / h);
  }
  return given;
}

}  // namespace

TEST_CASE("errors_refer_to_the_truth_that_is_asked_for") {
  const double order = GENERATE(1.0, 2.0);
  for (const Truth truth : {Truth::known, Truth::richardson}) {
    const Given given = converging(order, truth);
    const StudyResult result = evaluate(given.study, given.samples);
    for (const StudyRow& row : result.rows)
      CHECK(row.errors[0] == Approx(std::pow(row.setting.resolution, order)).epsilon(1e-9));
    REQUIRE(result.curves.size() == 1);
    CHECK(result.curves[0].order->order == Approx(order).epsilon(1e-6));
    CHECK(result.curves[0].cost_exponent == Approx(1).epsilon(1e-9));
    CHECK(result.curves[0].agrees);
  }
  const Given given = converging(order, Truth::finest);
  const StudyResult result = evaluate(given.study, given.samples);
  CHECK(std::isnan(result.rows.back().errors[0]));
  CHECK(result.rows[0].errors[0] == Approx(1 - std::pow(2.0, -7 * order)));
}

TEST_CASE("a_resolution_that_only_measuring_tells_makes_an_order") {
  Given given = converging(2, Truth::known);
  given.study.quantities.push_back({.name = "reached", .fact = true, .resolution = true});
  for (std::size_t k = 0; k < given.study.tasks.size(); ++k) {
    given.samples.tasks[k].values.push_back(given.study.tasks[k].setting.resolution);
    given.study.tasks[k].setting.resolution = NAN;
  }
  const StudyResult result = evaluate(given.study, given.samples);
  REQUIRE(result.curves.size() == 1);
  CHECK(result.curves[0].order->order == Approx(2).epsilon(1e-6));
}

TEST_CASE("an_order_that_is_not_that_of_theory_is_told") {
  Given given = converging(1, Truth::known);
  given.study.orders = {{.order = 2}};
  CHECK_FALSE(evaluate(given.study, given.samples).curves[0].agrees);
}

TEST_CASE("an_error_small_by_luck_does_not_make_a_setting_good") {
  Given given;
  given.add("", "", 1, 0.1, 1);
  given.add("", "", 0.5, 1e-9, 2);  // the error changes its sign here
  given.add("", "", 0.25, 0.02, 4);
  given.add("", "", 0.125, 0.01, 8);
  const StudyResult result = evaluate(given.study, given.samples);
  CHECK(result.rows[1].errors[0] == 1e-9);
  CHECK(result.rows[1].assured[0] == 0.02);
  const auto good = recommend(given.study, result, 0.015);
  REQUIRE(good.size() == 1);
  CHECK(good[0].row == std::size_t{3});
  CHECK_FALSE(recommend(given.study, result, 1e-3)[0].row);
  CHECK_THAT(recommend(given.study, result, 1e-3)[0].text, Catch::Contains("no setting reaches 0.001"));
}

TEST_CASE("answers_to_different_problems_do_not_compete") {
  Given given;
  given.add("easy", "a", 1, 0.1, 1);
  given.add("easy", "b", 1, 0.01, 2);
  given.add("hard", "a", 1, 0.5, 10);
  const StudyResult result = evaluate(given.study, given.samples);
  REQUIRE(result.fronts.size() == 2);
  CHECK(result.fronts[0].rows == std::vector<std::size_t>{0, 1});
  CHECK(result.fronts[1].rows == std::vector<std::size_t>{2});
  const auto wanted = recommend(given.study, result, 0.2);
  CHECK(wanted[0].row == std::size_t{0});
  CHECK_FALSE(wanted[1].row);
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
        given.add("", method, h, constant * std::pow(h, order) * random.uniform(0.8, 1.2), rate * std::pow(h, -cost));
      }
    }
    const StudyResult result = evaluate(given.study, given.samples);
    const double wanted = std::pow(10, random.uniform(-4, -1));
    const auto chosen = recommend(given.study, result, wanted).at(0).row;
    double least = INFINITY;
    for (const StudyRow& row : result.rows) {
      if (row.errors[0] <= wanted) least = std::min(least, row.time.median);
    }
    REQUIRE(chosen.has_value() == std::isfinite(least));
    if (!chosen) continue;
    kept += result.rows[*chosen].errors[0] <= wanted ? 1 : 0;
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
  const Given given = converging(1, Truth::known);
  Given other = converging(1, Truth::known);
  CHECK(given.study.checksum("here") == other.study.checksum("here"));
  CHECK(given.study.checksum("here") != given.study.checksum("there"));
  other.study.tasks[3].setting.values[0].second += 1e-15;
  CHECK(given.study.checksum("here") != other.study.checksum("here"));
}
