// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/assembly/space_filling_curve.hpp"

#include <algorithm>
#include <numeric>

#include "equidem/core/random.hpp"

#include "support/catch.hpp"

using namespace equidem;

TEST_CASE("hilberts_curve_steps_from_neighbour_to_neighbour") {
  const int side = GENERATE(2, 16, 64);
  std::vector<Vec2> points;
  for (int k = 0; k < side * side; ++k) points.push_back({1.0 * (k % side), 1.0 * (k / side)});
  // Points in the middle of the cells of a grid: the square of the curve reaches from corner to corner.
  points.push_back({-0.5, -0.5});
  points.push_back({side - 0.5, side - 0.5});

  std::vector<std::int32_t> order = hilbert_order(points);

  std::erase_if(order, [&](std::int32_t k) { return k >= side * side; });
  CAPTURE(side);
  REQUIRE(order.size() == static_cast<std::size_t>(side * side));
  for (std::size_t k = 1; k < order.size(); ++k) {
    const Vec2 step = points[order[k]] - points[order[k - 1]];
    CHECK(dot(step, step) == 1);
  }
}

TEST_CASE("an_order_names_every_point_once_and_equal_points_in_turn") {
  Random random(1);
  std::vector<Vec2> points(1000);
  for (Vec2& p : points) p = {random.uniform(), 0.01 * random.uniform()};
  points.insert(points.end(), {points[3], points[17], points[3], {0.5, 0.005}});

  const std::vector<std::int32_t> order = hilbert_order(points);

  std::vector<std::int32_t> sorted = order;
  std::sort(sorted.begin(), sorted.end());
  std::vector<std::int32_t> all(points.size());
  std::iota(all.begin(), all.end(), 0);
  CHECK(sorted == all);
  const auto at = [&](std::int32_t k) { return std::find(order.begin(), order.end(), k) - order.begin(); };
  CHECK(at(1000) == at(3) + 1);
  CHECK(at(1002) == at(3) + 2);
  CHECK(at(1001) == at(17) + 1);
  CHECK(hilbert_order({}).empty());
  CHECK(hilbert_order(std::vector<Vec2>{{1, 1}, {1, 1}}) == std::vector<std::int32_t>{0, 1});
}
