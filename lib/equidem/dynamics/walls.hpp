// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// What walls do, and whether they leave room for the discs.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/dynamics/simulation.hpp"

namespace equidem {

/// What walls exert on discs and store.
struct WallPushes {
  std::vector<Vec2> forces;  ///< N/m, per disc; empty where there is no wall
  double energy = 0;         ///< N
};

/// Of all walls on all discs displaced by `motions`: -kN gap n where the gap is negative.
WallPushes wall_pushes(const Scene& scene, const std::vector<DiscMotion>& motions, double time);

/// Check wall k by itself, against the other walls, and against the discs where they start.
///
/// Two walls may cross as the sides of a box do, with all discs inside the corner: no centre of a disc lies behind a
/// wall. Two walls that face each other never touch, at the start or later; where both move that is seen at the turning
/// points of either.
/// \throws Error (bad_input) on a spring that is not positive, a normal that is no unit vector, numbers that are not
///         finite, a periodic assembly (it has no outside), two walls that face each other and cross, a disc behind
void check_wall(std::span<const Wall> walls, std::size_t k, const Assembly& assembly);

/// The same for every wall.
void check_walls(std::span<const Wall> walls, const Assembly& assembly);

}  // namespace equidem
