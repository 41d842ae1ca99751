// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/assembly/point_process.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "equidem/assembly/space_filling_curve.hpp"
#include "equidem/core/random.hpp"

#include "support/catch.hpp"

using namespace equidem;

namespace {

/// Distance of a point to the nearest other, across the sides where periodic; by comparing all.
double nearest(const PointSet& set, std::size_t k, bool periodic) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t j = 0; j < set.points.size(); ++j) {
    if (j == k) continue;
    Vec2 d = set.points[j] - set.points[k];
    if (periodic) {
      d.x -= set.extent.x * std::round(d.x / set.extent.x);
      d.y -= set.extent.y * std::round(d.y / set.extent.y);
    }
    least = std::min(least, dot(d, d));
  }
  return std::sqrt(least);
}

}  // namespace

TEST_CASE("poisson_disc_points_keep_their_distance_and_leave_no_gap") {
  const bool periodic = GENERATE(true, false);
  const double aspect = GENERATE(1.0, 3.0);
  const std::uint64_t seed = GENERATE(1, 2);
  Random random(seed);
  const PointSet set =
      poisson_disc_points({.count = 1500, .spacing = 2, .aspect = aspect, .periodic = periodic}, random);

  double closest = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < set.points.size(); ++k) closest = std::min(closest, nearest(set, k, periodic));
  // No place is further than the least distance from all points: no more fit.
  double widest = 0;
  for (int k = 0; k < 3000; ++k) {
    PointSet probe = set;
    probe.points.push_back({random.uniform() * set.extent.x, random.uniform() * set.extent.y});
    widest = std::max(widest, nearest(probe, set.points.size(), periodic));
  }
  CAPTURE(periodic, aspect, seed, set.points.size(), closest, widest);
  CHECK(widest < closest * 1.01);
  // Random sequential adsorption of discs ends at a coverage of 0.547 (Feder 1980); free sides are crowded.
  const double coverage =
      std::acos(-1.0) / 4 * closest * closest * static_cast<double>(set.points.size()) / (set.extent.x * set.extent.y);
  CHECK(coverage == Approx(periodic ? 0.547 : 0.56).epsilon(0.03));
  CHECK(static_cast<double>(set.points.size()) == Approx(1500).epsilon(5 * 0.25 / std::sqrt(1500)));
  CHECK(set.extent.x * set.extent.y ==
        Approx(2 * std::sqrt(3.0) * static_cast<double>(set.points.size())).epsilon(1e-12));
  CHECK(set.extent.x / set.extent.y == Approx(aspect));
}

TEST_CASE("perturbed_points_stay_near_their_lattice_sites") {
  const bool periodic = GENERATE(true, false);
  const double disorder = GENERATE(0.0, 0.1, 0.49);
  Random random(4);
  const PointSet set =
      perturbed_hexagonal_points({.count = 1000, .spacing = 1, .aspect = 1.5, .periodic = periodic}, disorder, random);

  const double row_distance = std::sqrt(3.0) / 2;
  const auto columns = static_cast<std::size_t>(std::lround(set.extent.x));
  double furthest = 0;
  Vec2 mean;
  for (std::size_t k = 0; k < set.points.size(); ++k) {
    const std::size_t row = k / columns;
    const Vec2 site = {static_cast<double>(k % columns) + (row % 2 == 0 ? 0.25 : 0.75),
                       (static_cast<double>(row) + 0.5) * row_distance};
    Vec2 moved = set.points[k] - site;
    moved.x -= set.extent.x * std::round(moved.x / set.extent.x);
    moved.y -= set.extent.y * std::round(moved.y / set.extent.y);
    furthest = std::max(furthest, norm(moved));
    mean += moved / static_cast<double>(set.points.size());
  }
  CAPTURE(periodic, disorder, furthest, mean.x, mean.y);
  CHECK(furthest <= disorder * (1 + 1e-9) + 1e-12);
  CHECK(furthest >= 0.95 * disorder);
  CHECK(norm(mean) <= 4 * disorder / std::sqrt(2.0 * static_cast<double>(set.points.size())) + 1e-12);
  CHECK(static_cast<double>(set.points.size()) == Approx(1000).epsilon(0.05));
  CHECK(set.extent.x / set.extent.y == Approx(1.5).epsilon(0.1));
}

TEST_CASE("points_lie_in_their_rectangle") {
  const bool periodic = GENERATE(true, false);
  const std::int64_t count = GENERATE(1, 7, 2000);
  const PointOptions options = {.count = count, .spacing = 0.01, .aspect = 0.4, .periodic = periodic};
  Random random(9);
  for (const PointSet& set : {uniform_points(options, random), poisson_disc_points(options, random),
                              perturbed_hexagonal_points(options, 0.49, random)}) {
    CAPTURE(periodic, count, set.points.size());
    CHECK(!set.points.empty());
    for (const Vec2 p : set.points) {
      CHECK(p.x >= 0);
      CHECK(p.y >= 0);
      CHECK(p.x <= set.extent.x);
      CHECK(p.y <= set.extent.y);
    }
  }
  CHECK(uniform_points(options, random).points.size() == static_cast<std::size_t>(count));
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
