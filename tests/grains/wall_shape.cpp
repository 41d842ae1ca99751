// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "equidem/core/error.hpp"
#include "equidem/core/random.hpp"
#include "equidem/motion/wall.hpp"

#include "support/catch.hpp"
#include "support/refusal.hpp"

using namespace equidem;

namespace {

using Shape = Wall::Shape;
using std::numbers::pi;

Wall line(Vec2 point, double angle) {
  return {.shape = Shape::line, .name = "w", .point = point, .normal = {std::cos(angle), std::sin(angle)}};
}
Wall segment(Vec2 point, Vec2 end) {
  return {.shape = Shape::segment, .name = "w", .point = point, .end = end};
}
Vec2 at_random(Random& random, double size) {
  return {random.uniform(-size, size), random.uniform(-size, size)};
}

Wall thin_wall(Random& random) {
  const Vec2 point = at_random(random, 1);
  return segment(point, at_random(random, 1));
}

/// Points of a thin wall from end to end, evenly spaced.
std::vector<Vec2> sampled(const Wall& wall, int pieces) {
  std::vector<Vec2> points;
  for (int k = 0; k <= pieces; ++k) {
    points.push_back(wall.point + static_cast<double>(k) / pieces * (wall.end - wall.point));
  }
  return points;
}

double least_distance(const std::vector<Vec2>& points, Vec2 from) {
  double least = std::numeric_limits<double>::infinity();
  for (const Vec2 p : points) least = std::min(least, norm(from - p));
  return least;
}

/// Whether two ways cross, from the solution of the two linear equations for where.
bool ways_cross(Vec2 a, Vec2 b, Vec2 c, Vec2 d) {
  const Vec2 u = b - a;
  const Vec2 v = d - c;
  const double s = cross(c - a, v) / cross(u, v);
  const double t = cross(c - a, u) / cross(u, v);
  return s >= 0 && s <= 1 && t >= 0 && t <= 1;
}

bool crosses_samples(const std::vector<Vec2>& points, Vec2 before, Vec2 after) {
  for (std::size_t k = 1; k < points.size(); ++k) {
    if (ways_cross(points[k - 1], points[k], before, after)) return true;
  }
  return false;
}

/// The wall a little longer or shorter.
Wall changed(Wall wall, double share) {
  const Vec2 along = share * (wall.end - wall.point);
  wall.point -= along;
  wall.end += along;
  return wall;
}

std::string refusal(const Wall& wall) {
  const test::Refusal refused = test::refusal_of([&] { check(wall); });
  return refused.kind == ErrorKind::bad_input ? refused.message : "wrong kind";
}

}  // namespace

TEST_CASE("no_point_of_a_thin_wall_is_nearer_than_the_nearest") {
  Random random(1);
  for (int k = 0; k < 300; ++k) {
    const Wall wall = thin_wall(random);
    const std::vector<Vec2> points = sampled(wall, 2000);
    const double spacing = norm(points[1] - points[0]);
    for (int probe = 0; probe < 5; ++probe) {
      const Vec2 displacement = at_random(random, 5);
      const Vec2 centre = at_random(random, 3);
      const WallContact found = nearest(wall, displacement, centre + displacement);
      const double sampled_distance = least_distance(points, centre);
      const Vec2 foot = centre - found.distance * found.normal;
      CAPTURE(static_cast<int>(wall.shape), k, probe, found.distance, sampled_distance, spacing);
      CHECK(norm(found.normal) == Approx(1).epsilon(1e-14));
      CHECK(found.distance <= sampled_distance + 1e-12);
      CHECK(least_distance(points, foot) <= 0.5 * spacing + 1e-12);
    }
  }
}

TEST_CASE("the_distance_from_a_line_has_a_sign_and_its_normal_never_turns") {
  Random random(2);
  for (int k = 0; k < 200; ++k) {
    const Wall wall = line(at_random(random, 2), random.uniform(0, 2 * pi));
    const Vec2 displacement = at_random(random, 2);
    const double height = random.uniform(-3, 3);
    const Vec2 foot = wall.point + displacement + random.uniform(-9, 9) * perpendicular(wall.normal);
    const WallContact found = nearest(wall, displacement, foot + height * wall.normal);
    CAPTURE(k, height, found.distance);
    CHECK(std::abs(found.distance - height) < 1e-14 * 20);
    CHECK(found.normal == wall.normal);
    const auto passes = [&](double before, double after) {
      return passes_through(wall, foot - displacement + before * wall.normal,
                            foot - displacement + after * wall.normal);
    };
    CHECK(passes(1, -1));
    CHECK(passes(-1, 1));
    CHECK_FALSE(passes(1, 0.1));
    CHECK_FALSE(passes(-1, -0.1));
  }
}

TEST_CASE("next_to_a_thin_wall_the_normal_is_its_own") {
  Random random(3);
  for (int k = 0; k < 500; ++k) {
    const Wall wall = thin_wall(random);
    const double share = random.uniform(0.01, 0.99);
    const Vec2 own = perpendicular(wall.end - wall.point) / norm(wall.end - wall.point);
    const Vec2 on = wall.point + share * (wall.end - wall.point);
    for (const double height : {1e-3, 1e-9, 1e-14, 0.0, -1e-14, -1e-9, -1e-3}) {
      const WallContact found = nearest(wall, {}, on + height * own);
      CAPTURE(static_cast<int>(wall.shape), k, height, found.distance, found.normal.x, found.normal.y, own.x, own.y);
      CHECK(std::abs(found.distance - std::abs(height)) < 1e-14);
      CHECK(std::abs(cross(found.normal, own)) < 1e-14);
      if (std::abs(height) > 1e-13) CHECK(dot(found.normal, height * own) > 0);
    }
  }
}

TEST_CASE("a_way_passes_through_where_it_crosses_the_samples_of_the_wall") {
  Random random(4);
  int passed = 0;
  int not_passed = 0;
  int near_an_end = 0;
  for (int k = 0; k < 3000; ++k) {
    const Wall wall = thin_wall(random);
    const Vec2 before = at_random(random, 1.5);
    const Vec2 after = at_random(random, 1.5);
    const bool smaller = crosses_samples(sampled(changed(wall, -1e-4), 500), before, after);
    const bool larger = crosses_samples(sampled(changed(wall, 1e-4), 500), before, after);
    if (smaller != larger) {
      ++near_an_end;
      continue;
    }
    ++(larger ? passed : not_passed);
    CAPTURE(static_cast<int>(wall.shape), k, before.x, before.y, after.x, after.y);
    CHECK(passes_through(wall, before, after) == larger);
    CHECK(passes_through(wall, after, before) == larger);
  }
  CAPTURE(passed, not_passed, near_an_end);
  CHECK(passed > 500);
  CHECK(not_passed > 500);
  CHECK(near_an_end < 20);
}

TEST_CASE("of_two_ways_that_meet_on_the_wall_one_passes") {
  std::vector<Wall> walls = {line({0, 2}, pi), segment({0, -1}, {0, 3}), segment({0, 3}, {0, -1})};
  walls[0].normal = {-1, 0};
  for (const Wall& wall : walls) {
    const Vec2 own = nearest(wall, {}, {0, 0}).normal;
    CAPTURE(own.x, own.y);
    CHECK_FALSE(passes_through(wall, {0, 0}, 0.5 * own));
    CHECK(passes_through(wall, {0, 0}, -0.5 * own));
    for (const auto& [before, after] : {std::array<Vec2, 2>{{{-1, 0}, {1, 0}}}, {{{1, 0}, {-1, 0}}}}) {
      CAPTURE(static_cast<int>(wall.shape), before.x);
      CHECK(passes_through(wall, before, after));
      CHECK(passes_through(wall, before, {0, 0}) != passes_through(wall, {0, 0}, after));
      CHECK_FALSE(passes_through(wall, {0, 0}, {0, 0}));
      // There and back again: both or none.
      CHECK(passes_through(wall, before, {0, 0}) == passes_through(wall, {0, 0}, before));
    }
  }
}

TEST_CASE("no_place_of_the_centre_makes_a_contact_that_is_no_number") {
  const double tiny = 5e-324;
  const std::vector<Wall> walls = {line({0, 0}, 1), segment({0, 0}, {1, 0}), segment({0, 0}, {0, 1e-100})};
  for (const Wall& wall : walls) {
    REQUIRE(refusal(wall).empty());
    const std::vector<Vec2> points = sampled(wall, 8);
    for (const double x : {0.0, tiny, -1e-200, 1e-160, 1e-30, 1.0, -1e100}) {
      for (const double y : {0.0, -tiny, 1e-200, -1e-160, 1e-30, 1.0, 1e100}) {
        for (Vec2 centre :
             {Vec2{x, y}, points.front() + Vec2{x, y}, points.back() + Vec2{x, y}, points[4] + Vec2{x, y}}) {
          const WallContact found = nearest(wall, {}, centre);
          CAPTURE(static_cast<int>(wall.shape), centre.x, centre.y, found.distance);
          CHECK(std::isfinite(found.distance));
          CHECK(std::abs(norm(found.normal) - 1) < 1e-14);
          CHECK_FALSE(passes_through(wall, centre, centre));
        }
      }
    }
  }
}

TEST_CASE("walls_that_stand_nowhere_are_refused") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinite = std::numeric_limits<double>::infinity();
  CHECK(refusal(line({0, 0}, 1)).empty());
  CHECK(refusal(segment({0, 0}, {0, 1e-9})).empty());

  Wall slanted = line({0, 0}, 1);
  slanted.normal = {1, 1};
  CHECK_THAT(refusal(slanted), Catch::Contains("(1, 1), which is no unit vector"));
  slanted.normal = {nan, 1};
  CHECK_THAT(refusal(slanted), Catch::Contains("no unit vector"));
  for (const auto& wall : {line({nan, 0}, 1), segment({0, infinite}, {1, 0})}) {
    CHECK_THAT(refusal(wall), Catch::Contains("wall 'w' stands at"));
  }
  CHECK_THAT(refusal(segment({0, 0}, {nan, 0})), Catch::Contains("ends at (nan, 0)"));
  CHECK_THAT(refusal(segment({1, 2}, {1, 2})), Catch::Contains("begins and ends at (1, 2)"));
  Wall moving = line({0, 0}, 1);
  moving.move_y.value = nan;
  CHECK_FALSE(refusal(moving).empty());
}
