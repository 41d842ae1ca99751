// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Nearest point of a wall, and crossing of a wall.
#pragma once

#include "equidem/core/vector.hpp"
#include "equidem/motion/wall.hpp"

namespace equidem {

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
