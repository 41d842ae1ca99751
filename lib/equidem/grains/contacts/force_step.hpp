// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Steps in which every contact is evaluated by itself: laws that give a force, and the maps.
#pragma once

#include <cmath>

#include "equidem/grains/grain_system.hpp"

namespace equidem {

using CollideFunction = void (*)(GrainSystem&);

/// The loop over contacts compiled for a force law or a map, with or without friction: impulses of this step from
/// positions and velocities. Null for a simultaneous law.
CollideFunction collide_function(NormalLaw law, bool friction);

/// What the dashpot of a contact takes in a step, J, and where attraction is cut what the spring loses: its force at
/// the mean velocity of the step, to the second order of the step: what other forces changed in the last step of the
/// contact they change again. \param candidate as the last step left it
/// \param depth, unit, unit_speed overlap over the length, and the units of step.change as impulse and as speed
/// \param eccentric the reduced mass over that of the contact points along the normal: 1 where the normal passes
///         through both centres
template <class Law>
double dashpot_heat(const Candidate& candidate, const ContactStep& step, double depth, double closing, double unit,
                    double unit_speed, double eccentric = 1) {
  const double spring = -Law::spring(candidate.a, depth);
  const double by_others =
      candidate.steps > 0 ? closing - candidate.closing + eccentric * candidate.impulse / candidate.reduced_mass : 0;
  return (spring - step.change) * unit * (closing + 0.5 * (eccentric * step.change * unit_speed + by_others));
}

/// system.bodies.next from the impulses: v' = v + a dt, x' = x + v' dt (+ the shifts of maps).
void move_by_euler(GrainSystem& system);

/// system.bodies.next: half a kick by the impulses of the last step, then the way of a step.
void drift_of_verlet(GrainSystem& system);
/// The other half of the kick, by the impulses found with the velocities of the half step.
void kick_of_verlet(GrainSystem& system);

}  // namespace equidem
