// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Walls: lines and segments, at rest or moving.
///
/// Nearest point of a wall, and crossing of a wall.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "equidem/core/names.hpp"
#include "equidem/core/vector.hpp"
#include "equidem/motion/schedule.hpp"
#include "equidem/motion/servo.hpp"

namespace equidem {

/// A wall of infinite mass. Bodies are outside a line on the side of its normal; segments are thin, with two
/// sides and two ends. The normal of a segment points to the left of the direction from `point` to `end`; a centre
/// exactly on a wall counts as on that side.
///
/// Bonded discs take lines with a spring kN, without friction. Colliding bodies take both shapes; stiffness,
/// restitution and friction follow from `kind`.
struct Wall {
  enum class Shape { line, segment } shape = Shape::line;
  std::string name;
  Vec2 point;                         ///< line: a point on it; segment: first end. m
  Vec2 normal = {0, 1};               ///< line: unit, towards the bodies
  Vec2 end = {};                      ///< segment: second end, m
  Schedule move_x = {}, move_y = {};  ///< displacement over time, m; constant 0: at rest
  int kind = 0;                       ///< colliding bodies: row of the table of pairs
  double kN = 0;                      ///< bonded discs: force per m of overlap, Pa, > 0
  std::optional<Servo> servo = {};    ///< motion that is added to the displacement; colliding bodies

  /// Whether a schedule moves it.
  [[nodiscard]] bool moves() const { return move_x.changes() || move_y.changes(); }
  /// Displacement by its schedules.
  [[nodiscard]] Vec2 displacement(double time) const { return {move_x.at(time), move_y.at(time)}; }
  /// Displacement of a line along its normal, m.
  [[nodiscard]] double displacement_along_normal(double time) const { return dot(normal, displacement(time)); }
};

template <>
struct EnumNames<Wall::Shape> {
  using enum Wall::Shape;
  static constexpr const char* what = "shape of a wall";
  static constexpr NamedValue<Wall::Shape> list[] = {{line, "line"}, {segment, "segment"}};
};

/// A wall of a simulation at its time, and what bodies have done to it. N, J, N s: of discs per metre of depth.
struct WallState {
  std::string name = {};
  Vec2 place = {};     ///< of Wall::point, m
  Vec2 velocity = {};  ///< in the step that follows, m/s
  Vec2 force = {};     ///< of the bodies on the wall, mean over the last step, N
  double moment = 0;   ///< of this force about `place`, counter-clockwise, N m
  Vec2 impulse = {};   ///< of this force since the start, N s
  double work = 0;     ///< done on the bodies since the start, J
};

/// Prescribe the displacement of a wall along a direction.
/// \param direction unit
void move_along(Wall& wall, Vec2 direction, const Schedule& displacement);

std::vector<std::string> names_of(std::span<const Wall> walls);

/// \throws Error (bad_input) on numbers that are not finite, a normal that is not a unit vector, a segment of length 0
void check(const Wall& wall);

/// The point of a wall nearest to a grain.
struct WallContact {
  double distance = 0;  ///< from the wall to the centre; line: signed, negative behind the wall
  Vec2 normal;          ///< unit, from the wall to the centre
  int end = 0;          ///< 1, 2: the point is the first or second end of a segment, or next to it
};

/// nearest() for a segment, without displacement.
WallContact nearest_of_segment(const Wall& wall, const Vec2& centre);

/// Line: the foot of the perpendicular. Segment: the nearest point, ends included. Never NaN for a wall that passes
/// `check`: for a centre on a segment the normal is the wall's own.
/// \param displacement present displacement of the wall, m
inline WallContact nearest(const Wall& wall, const Vec2& displacement, const Vec2& centre) {
  const Vec2 relative = centre - displacement;
  if (wall.shape == Wall::Shape::line) return {dot(wall.normal, relative - wall.point), wall.normal, 0};
  return nearest_of_segment(wall, relative);
}

/// Whether a centre that moves straight from `before` to `after` (both relative to the wall: less its displacement)
/// passes through the wall: changes side on it, ends included. If two successive paths meet on the wall and lead
/// through it, exactly one of them passes.
bool passes_through(const Wall& wall, const Vec2& before, const Vec2& after);

}  // namespace equidem
