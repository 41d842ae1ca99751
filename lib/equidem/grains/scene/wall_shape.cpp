// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/grains/scene/wall_shape.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/core/turns.hpp"

namespace equidem {
namespace {

constexpr double whole_turn = 2 * std::numbers::pi;
/// Of angles that are meant to be a whole turn apart, rad per rad.
constexpr double rounding = 1e-15;
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

WallContact nearest_of_segment(const GrainWall& wall, const Vec2& centre) {
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
  explicit Span(const GrainWall& arc)
      : angle_(arc.to - arc.from), first_(direction(arc.from)), last_(direction(arc.to)) {}

  [[nodiscard]] bool has(const Vec2& p) const {
    if (angle_ >= whole_turn * (1 - rounding)) return true;
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

WallContact nearest_of_arc(const GrainWall& wall, const Vec2& centre) {
  const Vec2 p = centre - wall.point;
  const double distance = norm(p);
  if (distance < shortest) return {wall.radius, -direction(0.5 * (wall.from + wall.to)), 0};
  const Span span(wall);
  if (span.has(p)) {
    const Vec2 outwards = p / distance;
    const double height = distance - wall.radius;
    const bool whole = wall.to - wall.from >= whole_turn * (1 - rounding);
    const auto beside = [&](const Vec2& ray) { return !whole && norm(outwards - ray) <= next_to; };
    const int end = beside(span.first()) ? 1 : beside(span.last()) ? 2 : 0;
    return height < 0 ? WallContact{-height, -outwards, end} : WallContact{height, outwards, end};
  }
  const WallContact first = contact_with_end(1, p - wall.radius * span.first(), span.first());
  const WallContact last = contact_with_end(2, p - wall.radius * span.last(), span.last());
  return last.distance < first.distance ? last : first;
}

bool segment_is_passed(const GrainWall& wall, const Vec2& before, const Vec2& after) {
  const Vec2 along = wall.end - wall.point;
  const auto on_own_side = [&](const Vec2& p) { return cross(along, p - wall.point) >= 0; };
  if (on_own_side(before) == on_own_side(after)) return false;
  const Vec2 way = after - before;
  const double point_left = cross(way, wall.point - before);
  const double end_left = cross(way, wall.end - before);
  return (point_left <= 0 && end_left >= 0) || (point_left >= 0 && end_left <= 0);
}

/// The way meets the circle where |b + t w|^2 = R^2, A t^2 + 2 B t + C = 0.
bool arc_is_passed(const GrainWall& wall, const Vec2& before, const Vec2& after) {
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

bool is_finite(const Vec2& p) {
  return std::isfinite(p.x) && std::isfinite(p.y);
}

[[noreturn]] void refuse(const GrainWall& wall, const std::string& what, std::string why, std::string remedy) {
  bad_input(fmt::format("wall '{}' {}", wall.name, what), std::move(why), std::move(remedy));
}

void check_line(const GrainWall& wall) {
  // Written so that it also refuses what is no number.
  if (std::abs(dot(wall.normal, wall.normal) - 1) <= 1e-12) return;
  refuse(wall, fmt::format("has the normal ({}, {}), which is no unit vector", wall.normal.x, wall.normal.y),
         "distances are measured with it", "Divide it by its length");
}

void check_segment(const GrainWall& wall) {
  if (!is_finite(wall.end)) {
    refuse(wall, fmt::format("ends at ({}, {}) m", wall.end.x, wall.end.y), "it stands nowhere", "Give finite numbers");
  }
  if (norm(wall.end - wall.point) >= shortest) return;
  refuse(wall, fmt::format("begins and ends at ({}, {}) m", wall.end.x, wall.end.y),
         "a segment without length has no sides", "Move one of its ends");
}

void check_arc(const GrainWall& wall) {
  if (!(wall.radius >= shortest) || !std::isfinite(wall.radius)) {
    refuse(wall, fmt::format("has radius = {} m", wall.radius), "that of an arc must be > 0 and finite",
           "Give a positive one");
  }
  const double angle = wall.to - wall.from;
  if (!(angle > 0) || !std::isfinite(angle)) {
    refuse(wall, fmt::format("goes from {} to {} rad", wall.from, wall.to), "an arc runs counter-clockwise, to > from",
           "Exchange the angles, or add 2 pi to the second");
  }
  if (angle > whole_turn * (1 + rounding) + rounding * std::abs(wall.from)) {
    refuse(wall, fmt::format("goes from {} to {} rad", wall.from, wall.to), "an arc is at most 2 pi long",
           "Take 2 pi for a whole circle");
  }
}

}  // namespace

WallContact nearest(const GrainWall& wall, const Vec2& displacement, const Vec2& centre) {
  const Vec2 relative = centre - displacement;
  switch (wall.shape) {
    case GrainWall::Shape::line:
      return {dot(wall.normal, relative - wall.point), wall.normal, 0};
    case GrainWall::Shape::segment:
      return nearest_of_segment(wall, relative);
    case GrainWall::Shape::arc:
      return nearest_of_arc(wall, relative);
  }
  return {};
}

bool passes_through(const GrainWall& wall, const Vec2& before, const Vec2& after) {
  switch (wall.shape) {
    case GrainWall::Shape::line:
      return (dot(wall.normal, before - wall.point) >= 0) != (dot(wall.normal, after - wall.point) >= 0);
    case GrainWall::Shape::segment:
      return segment_is_passed(wall, before, after);
    case GrainWall::Shape::arc:
      return arc_is_passed(wall, before, after);
  }
  return false;
}

void check(const GrainWall& wall) {
  if (!is_finite(wall.point)) {
    refuse(wall, fmt::format("stands at ({}, {}) m", wall.point.x, wall.point.y), "it stands nowhere",
           "Give finite numbers");
  }
  switch (wall.shape) {
    case GrainWall::Shape::line:
      check_line(wall);
      break;
    case GrainWall::Shape::segment:
      check_segment(wall);
      break;
    case GrainWall::Shape::arc:
      check_arc(wall);
      break;
  }
  check(wall.move_x);
  check(wall.move_y);
}

}  // namespace equidem
