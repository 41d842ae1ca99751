// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Servo control of walls (motion/wall.hpp) between the steps of colliding bodies.
#pragma once

#include <vector>

#include "equidem/grains/grain_system.hpp"

namespace equidem {

/// Springs and dashpots of a contact or a bond along and across its normal, N/m and N s/m.
struct ContactResistance {
  double k_n = 0, k_t = 0, c_n = 0, c_t = 0;
};
/// That along the normal. \param dashpot as dashpot_of
ContactResistance resistance_along(const LawDescription& law, double stiffness, double dashpot, double overlap);
/// That of a contact with the overlap of the last step.
ContactResistance resistance_of(const GrainSystem& system, const ContactConstants& constants, double overlap);

/// Set system.walls.servos for the servo walls of the scene, at rest.
void find_servos(GrainSystem& system);

/// Set the way on which a servo wall may meet no body: the diagonal of the box that holds all bodies and all points of
/// walls. The walls are placed.
void limit_free_way(GrainSystem& system);

/// Choose the speeds of all servo walls for the next step from the forces of the last one.
/// \throws Error (computation_failed) if a wall has met no body on a longer way than the scene is large, or if the
///         walls between which its length is measured have met
void steer_walls(GrainSystem& system);

/// Add the motion of servo walls to their places.
void place_servo_walls(GrainSystem& system);

/// In the caller's order of the walls.
std::vector<ServoReport> reports_of(const GrainSystem& system);

}  // namespace equidem
