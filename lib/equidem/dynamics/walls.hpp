// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Forces and energy of walls, and checks of their positions.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/dynamics/simulation.hpp"

namespace equidem {

/// A disc that a wall pushes.
struct DiscAtWall {
  std::size_t wall = 0, disc = 0;
  double gap = 0;  ///< m, negative; the force on the disc is -kN gap along the normal of the wall
};
std::vector<DiscAtWall> wall_contacts(const Scene& scene, const std::vector<DiscMotion>& motions, double time);

/// Forces of walls on discs, and their elastic energy.
struct WallPushes {
  std::vector<Vec2> forces;  ///< N/m, per disc; empty where there is no wall
  double energy = 0;         ///< N
};

/// Forces of all walls on all discs displaced by `motions`: -kN gap n where the gap is negative.
WallPushes wall_pushes(const Scene& scene, const std::vector<DiscMotion>& motions, double time);

/// Check wall k by itself, against the other walls, and against the initial positions of the discs.
///
/// Two walls may cross as the sides of a box do, with all discs inside the corner: no centre of a disc lies behind a
/// wall. Two walls that face each other never touch, at the start or later; if both move, this is checked at the
/// extremes of either motion.
/// \throws Error (bad_input) on a spring that is not positive, a normal that is not a unit vector, numbers that are not
///         finite, a periodic assembly (it has no outside), two walls that face each other and cross, a disc behind
void check_wall(std::span<const Wall> walls, std::size_t k, const Assembly& assembly);

}  // namespace equidem
