// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <vector>

#include "equidem/core/random.hpp"
#include "equidem/study/evaluate.hpp"

#include "support/catch.hpp"

using namespace equidem;

namespace {

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

}  // namespace

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
