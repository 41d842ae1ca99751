// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Motion of bodies in a step, and the contacts of maps, each evaluated by itself.
///
/// A step of a simultaneous law (exact_flow): all contacts together.
///
/// Each contact is solved exactly over the step (exact_contact.hpp) under an outside force that is linear in time and
/// has the impulse and the first moment of all other forces on its two bodies; sweeps over the contacts repeat this
/// until convergence. The normal is the mean normal of the step, (r + r')/|r + r'|, and the displacement along it is
/// scaled to the change of the distance: the step is reversible in time, and elastic impacts conserve energy on
/// average.
///
/// The tangential force is constant over the step, its spring stretched by the way of the bodies, the moments of normal
/// forces included: slow loads lead to the forces of statics at any step.
#pragma once

#include "equidem/grains/contacts/block_step.hpp"
#include "equidem/grains/grain_system.hpp"

namespace equidem {

/// The loop compiled for a map, with or without friction: impulses of this step from positions and velocities. Null for
/// other laws.
CandidateLoop candidate_loop(NormalLaw law, bool friction);

/// Set system.bodies.next of a block from the impulses: v' = v + a dt, x' = x + v' dt (+ the shifts of maps); and
/// system.bodies.ways.
void move_by_euler(GrainSystem& system, std::size_t block);

/// Set system.bodies.next: half kick by the impulses of the last step, then the drift.
void drift_of_verlet(GrainSystem& system);
/// Second half kick of a block, by the impulses computed from the velocities at the half step.
void kick_of_verlet(GrainSystem& system, std::size_t block);

/// The step compiled for a simultaneous law; it sets system.bodies.next and the state of the contacts. Null for other
/// laws. The step throws:
/// \throws Error (computation_failed) if sweeps do not converge or bodies would pass through one another; the contacts
///         keep the state of the failed step
using FlowFunction = void (*)(GrainSystem&);
FlowFunction flow_function(NormalLaw law);

}  // namespace equidem
