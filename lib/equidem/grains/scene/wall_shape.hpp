// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Where a body meets a wall, and whether it passes through.
#pragma once

#include "equidem/core/vector.hpp"
#include "equidem/motion/wall.hpp"

namespace equidem {

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
WallContact nearest(const Wall& wall, const Vec2& displacement, const Vec2& centre);

/// Whether a centre that moves straight from `before` to `after` (both relative to the wall: less its displacement)
/// passes through the wall: changes side on it, ends included, or crosses an arc and comes back. A path that touches an
/// arc from outside and turns away does not. Of two paths that meet on the wall and lead through it, one passes.
bool passes_through(const Wall& wall, const Vec2& before, const Vec2& after);

}  // namespace equidem
