// SPDX-License-Identifier: GPL-3.0-or-later
#include <array>
#include <cmath>
#include <functional>
#include <vector>

#include "equidem/core/random.hpp"
#include "equidem/study/evaluate.hpp"

#include "support/catch.hpp"

using namespace equidem;

namespace {

std::vector<Level> levels(int count, const std::function<double(double)>& error) {
  std::vector<Level> all;
  for (int k = 0; k < count; ++k) {
    const double h = std::pow(2.0, -k);
    all.push_back({h, error(h)});
  }
  return all;
}

}  // namespace

TEST_CASE("powers_of_the_resolution_have_their_exponent_as_order") {
  const double p = GENERATE(0.5, 1.0, 2.0, 4.0);
  const auto order = observed_order(levels(6, [&](double h) { return 3 * std::pow(h, p); }));
  REQUIRE(order);
  CHECK(order->order == Approx(p).epsilon(1e-12));
  CHECK(order->uncertainty < 1e-10);
  CHECK(order->constant == Approx(3).epsilon(1e-12));
  CHECK(order->error_at(0.01) == Approx(3 * std::pow(0.01, p)).epsilon(1e-12));
  CHECK(order->resolution_for(order->error_at(0.01)) == Approx(0.01).epsilon(1e-12));
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
