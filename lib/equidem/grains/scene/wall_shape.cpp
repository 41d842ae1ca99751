// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/grains/scene/wall_shape.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "equidem/core/turns.hpp"

namespace equidem {
namespace {

constexpr double whole_turn = 2 * std::numbers::pi;
/// Relative tolerance of angles that differ by a whole turn, rad per rad.
constexpr double angle_rounding = 1e-15;
/// A vector shorter than this has no direction: its square is no number.
constexpr double shortest = 1e-150;

Vec2 direction(double angle) {
  const double turns = angle / whole_turn;
  return {sine_of_turns(turns + 0.25), sine_of_turns(turns)};
}

/// From a point of the wall to the centre.
WallContact contact_with_end(int end, const Vec2& branch, const Vec2& own_normal) {
  const double distance = norm(branch);
  return distance < shortest ? WallContact{0, own_normal, end} : WallContact{distance, branch / distance, end};
}

/// Next to an end: of the length of a segment, of the radius of an arc.
constexpr double next_to = 1e-9;

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

/// Whether the ray from the centre of the arc through a point meets the arc.
class Span {
 public:
  explicit Span(const Wall& arc) : angle_(arc.to - arc.from), first_(direction(arc.from)), last_(direction(arc.to)) {}

  [[nodiscard]] bool has(const Vec2& p) const {
    if (angle_ >= whole_turn * (1 - angle_rounding)) return true;
    const double after_first = cross(first_, p);
    const double before_last = cross(p, last_);
    return angle_ <= std::numbers::pi ? after_first >= 0 && before_last >= 0 : after_first >= 0 || before_last >= 0;
  }
  [[nodiscard]] const Vec2& first() const { return first_; }
  [[nodiscard]] const Vec2& last() const { return last_; }

 private:
  double angle_;
  Vec2 first_, last_;
};

WallContact nearest_of_arc(const Wall& wall, const Vec2& centre) {
  const Vec2 p = centre - wall.point;
  const double distance = norm(p);
  if (distance < shortest) return {wall.radius, -direction(0.5 * (wall.from + wall.to)), 0};
  const Span span(wall);
  if (span.has(p)) {
    const Vec2 outwards = p / distance;
    const double height = distance - wall.radius;
    const bool whole = wall.to - wall.from >= whole_turn * (1 - angle_rounding);
    const auto beside = [&](const Vec2& ray) { return !whole && norm(outwards - ray) <= next_to; };
    const int end = beside(span.first()) ? 1 : beside(span.last()) ? 2 : 0;
    return height < 0 ? WallContact{-height, -outwards, end} : WallContact{height, outwards, end};
  }
  const WallContact first = contact_with_end(1, p - wall.radius * span.first(), span.first());
  const WallContact last = contact_with_end(2, p - wall.radius * span.last(), span.last());
  return last.distance < first.distance ? last : first;
}

bool segment_is_passed(const Wall& wall, const Vec2& before, const Vec2& after) {
  const Vec2 along = wall.end - wall.point;
  const auto on_own_side = [&](const Vec2& p) { return cross(along, p - wall.point) >= 0; };
  if (on_own_side(before) == on_own_side(after)) return false;
  const Vec2 way = after - before;
  const double point_left = cross(way, wall.point - before);
  const double end_left = cross(way, wall.end - before);
  return (point_left <= 0 && end_left >= 0) || (point_left >= 0 && end_left <= 0);
}

/// The way meets the circle where |b + t w|^2 = R^2, A t^2 + 2 B t + C = 0.
bool arc_is_passed(const Wall& wall, const Vec2& before, const Vec2& after) {
  const Vec2 b = before - wall.point;
  const Vec2 w = after - before;
  const double from_centre = norm(b);
  const bool outside_before = from_centre >= wall.radius;
  const bool outside_after = norm(after - wall.point) >= wall.radius;
  if (!outside_before && !outside_after) return false;
  const double A = dot(w, w);
  const double B = dot(b, w);
  const double C = (from_centre - wall.radius) * (from_centre + wall.radius);
  const double discriminant = B * B - A * C;
  const bool grazes = !(discriminant > 0) || B >= 0 || B <= -A;
  if (outside_before && outside_after && grazes) return false;
  const double root = std::sqrt(std::max(discriminant, 0.0));
  const Span span(wall);
  // The smaller root leads in, the larger out; each in the form that does not cancel.
  const auto meets_arc = [&](double t) { return span.has(b + std::clamp(t, 0.0, 1.0) * w); };
  const bool in = outside_before && meets_arc(B < 0 ? C / (root - B) : 0);
  const bool out = outside_after && meets_arc(B < 0 ? (root - B) / A : -C / (B + root));
  return in || out;
}

}  // namespace

WallContact nearest_of_bounded(const Wall& wall, const Vec2& centre) {
  return wall.shape == Wall::Shape::arc ? nearest_of_arc(wall, centre) : nearest_of_segment(wall, centre);
}

bool passes_through(const Wall& wall, const Vec2& before, const Vec2& after) {
  switch (wall.shape) {
    case Wall::Shape::line:
      return (dot(wall.normal, before - wall.point) >= 0) != (dot(wall.normal, after - wall.point) >= 0);
    case Wall::Shape::segment:
      return segment_is_passed(wall, before, after);
    case Wall::Shape::arc:
      return arc_is_passed(wall, before, after);
  }
  return false;
}

}  // namespace equidem
