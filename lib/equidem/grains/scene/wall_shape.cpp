// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/grains/scene/wall_shape.hpp"

#include <cmath>

namespace equidem {
namespace {

/// A vector shorter than this has no direction: its square is no number.
constexpr double shortest = 1e-150;

/// From a point of the wall to the centre.
WallContact contact_with_end(int end, const Vec2& branch, const Vec2& own_normal) {
  const double distance = norm(branch);
  return distance < shortest ? WallContact{0, own_normal, end} : WallContact{distance, branch / distance, end};
}

/// Next to an end, of the length of a segment.
constexpr double next_to = 1e-9;

bool segment_is_passed(const Wall& wall, const Vec2& before, const Vec2& after) {
  const Vec2 along = wall.end - wall.point;
  const auto on_own_side = [&](const Vec2& p) { return cross(along, p - wall.point) >= 0; };
  if (on_own_side(before) == on_own_side(after)) return false;
  const Vec2 way = after - before;
  const double point_left = cross(way, wall.point - before);
  const double end_left = cross(way, wall.end - before);
  return (point_left <= 0 && end_left >= 0) || (point_left >= 0 && end_left <= 0);
}

}  // namespace

WallContact nearest_of_segment(const Wall& wall, const Vec2& centre) {
  const Vec2 along = wall.end - wall.point;
  const Vec2 branch = centre - wall.point;
  const double length = norm(along);
  const Vec2 own_normal = perpendicular(along) / length;
  const double foot = dot(branch, along);
  if (foot < 0) return contact_with_end(1, branch, own_normal);
  if (foot > length * length) return contact_with_end(2, centre - wall.end, own_normal);
  const double share = foot / (length * length);
  const int end = share <= next_to ? 1 : share >= 1 - next_to ? 2 : 0;
  // By its height and not from the foot: next to the wall the difference would be all rounding.
  const double height = cross(along, branch) / length;
  return height < 0 ? WallContact{-height, -own_normal, end} : WallContact{height, own_normal, end};
}

bool passes_through(const Wall& wall, const Vec2& before, const Vec2& after) {
  if (wall.shape == Wall::Shape::segment) return segment_is_passed(wall, before, after);
  return (dot(wall.normal, before - wall.point) >= 0) != (dot(wall.normal, after - wall.point) >= 0);
}

}  // namespace equidem
