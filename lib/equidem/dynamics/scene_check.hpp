// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Walls of bonded discs: gaps, forces and energy; the unknowns of a scene in statics; check of a scene for
/// contradictions.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/contact/effects.hpp"
#include "equidem/dynamics/simulation.hpp"
#include "equidem/statics/number_unknowns.hpp"

namespace equidem {

/// Gap between a disc and a wall that has moved along its normal, m; negative: overlap.
inline double gap_to(const Wall& wall, double moved, Vec2 centre, double radius) {
  return dot(wall.normal, centre - wall.point) - moved - radius;
}

/// Force of the spring of a wall on a disc, N/m: -kN gap n.
inline Vec2 force_of(const Wall& wall, double gap) {
  return -wall.kN * gap * wall.normal;
}

/// A disc that a wall pushes.
struct DiscAtWall {
  std::size_t wall = 0, disc = 0;
  double gap = 0;  ///< m, negative
};
std::vector<DiscAtWall> wall_contacts(const Scene& scene, const std::vector<DiscMotion>& motions, double time);

/// Forces of walls on discs, and their elastic energy.
struct WallPushes {
  std::vector<Vec2> forces;  ///< N/m, per disc; empty where there is no wall
  double energy = 0;         ///< N
};

/// Forces of all walls on all discs displaced by `motions`.
WallPushes wall_pushes(const Scene& scene, const std::vector<DiscMotion>& motions, double time);

/// Check wall k by itself, against the other walls, and against the initial positions of the discs.
///
/// Two walls may cross as the sides of a box do, with all discs inside the corner: no centre of a disc lies behind a
/// wall. Two walls that face each other never touch, at the start or later; if both move, this is checked at the
/// extremes of either motion.
/// \throws Error (bad_input) on a spring that is not positive, a normal that is not a unit vector, numbers that are not
///         finite, a periodic assembly (it has no outside), two walls that face each other and cross, a disc behind
void check_wall(std::span<const Wall> walls, std::size_t k, const Assembly& assembly);

/// Place of a part of a scene in the user's input, by its path such as "support.1.ux", "velocity.0.group" or "wall.2".
using PlaceInScene = std::function<std::string(const std::string& path)>;

/// No two supports give a component of a disc different motions, no disc has two initial velocities, no velocity is
/// given where a support prescribes the motion, no spin where rotations are no unknowns, and walls are as check_wall
/// says.
/// \param where for error messages; empty: the path is the place
/// \throws Error (bad_input)
void check(const Scene& scene, Rotation rotation, const PlaceInScene& where = {});

/// The unknowns left free by the supports of the scene, with the motions prescribed at the given time (s).
/// \throws Error (bad_input) as number_unknowns does
DegreesOfFreedom unknowns_at(const Scene& scene, const Effects& effects, double time);

}  // namespace equidem
