// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
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

#include "equidem/grains/grain_system.hpp"

namespace equidem {

/// The step compiled for a simultaneous law; it sets system.bodies.next and the state of the contacts. Null for other
/// laws. The step throws:
/// \throws Error (computation_failed) if sweeps do not converge or bodies would pass through one another; the contacts
///         keep the state of the failed step
using FlowFunction = void (*)(GrainSystem&);
FlowFunction flow_function(NormalLaw law);

}  // namespace equidem
