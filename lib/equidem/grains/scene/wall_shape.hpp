// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Walls that grains rebound from: lines, segments, arcs; standing or moving.
#pragma once

#include <string>

#include "equidem/core/vector.hpp"
#include "equidem/dynamics/schedule.hpp"

namespace equidem {

/// A wall of infinite mass. A line has an outside only on the side that its normal points to; segments and arcs are
/// thin and have two sides and two ends. The own normal of a segment points to the left of the way from `point` to
/// `end`, that of an arc away from its centre; a centre exactly on a wall counts as on that side.
struct GrainWall {
  enum class Shape { line, segment, arc } shape = Shape::line;
  std::string name;
  Vec2 point;               ///< line: on it; segment: first end; arc: centre. m
  Vec2 normal = {0, 1};     ///< line: unit, towards the grains
  Vec2 end = {};            ///< segment: second end, m
  double radius = 0;        ///< arc, m, > 0
  double from = 0, to = 0;  ///< arc: angles, counter-clockwise from `from` to `to` > from, at most 2 pi further; rad
  Schedule move_x = {}, move_y = {};  ///< displacement over time, m; constant 0: standing
  int kind = 0;                       ///< row of the table of pairs

  [[nodiscard]] bool moves() const { return move_x.changes() || move_y.changes(); }
};

/// The nearest point of a wall, seen from a grain.
struct WallContact {
  double distance = 0;  ///< from the wall to the centre; line: signed, negative behind the wall
  Vec2 normal;          ///< unit, from the wall to the centre
  int end = 0;          ///< 1, 2: the point is the first or second end of a segment or an arc, or next to it
};

/// Of a line its foot; of a segment or an arc the nearest of all its points, ends included. Never a NaN for a wall that
/// passes `check`: on a thin wall the normal is the wall's own; in the centre of an arc, from where all its points are
/// equally far, the contact is with its middle.
/// \param displacement of the wall now
WallContact nearest(const GrainWall& wall, const Vec2& displacement, const Vec2& centre);

/// Whether a centre that moves straight from `before` to `after` (both relative to the wall: less its displacement)
/// passes through the wall: changes side on it, ends included, or crosses an arc and comes back. A path that touches an
/// arc from outside and turns away does not. Of two paths that meet on the wall and lead through it, one passes.
bool passes_through(const GrainWall& wall, const Vec2& before, const Vec2& after);

/// \throws Error (bad_input) on numbers that are not finite, a normal that is no unit vector, a segment without length,
///         an arc without radius or with angles out of order
void check(const GrainWall& wall);

}  // namespace equidem
