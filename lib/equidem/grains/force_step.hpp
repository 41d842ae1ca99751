// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Steps in which every contact is evaluated by itself: laws that give a force, and the maps.
#pragma once

#include "equidem/grains/grain_system.hpp"

namespace equidem {

using CollideFunction = void (*)(GrainSystem&);

/// The loop over contacts compiled for a law, with or without friction: pushes of this step from positions and velocities.
CollideFunction collide_function(NormalLaw law, bool friction);

/// system.next from the pushes: v' = v + a dt, x' = x + v' dt (+ the shifts of maps).
void move_by_euler(GrainSystem& system);

/// system.next: half a kick by the pushes of the last step, then the way of a step.
void drift_of_verlet(GrainSystem& system);
/// The other half of the kick, by the pushes found with the velocities of the half step.
void kick_of_verlet(GrainSystem& system);

}  // namespace equidem
