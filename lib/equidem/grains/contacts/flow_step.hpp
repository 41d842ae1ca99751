// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A step of a simultaneous law (exact_flow): all contacts together.
///
/// Each contact is solved exactly over the step (exact_contact.hpp) under an outside force that is linear in time and
/// has the impulse and the first moment of all other forces on its two bodies; sweeps over the contacts repeat that
/// until nothing changes. The normal is the mean one of the step, (r + r')/|r + r'|, and the way along it is scaled so
/// that it is the change of the distance: the step is the same forwards and backwards in time, and elastic impacts keep
/// their energy on the average.
#pragma once

#include "equidem/grains/grain_system.hpp"

namespace equidem {

/// The step compiled for a simultaneous law: system.bodies.next, and what the contacts remember. Null for other laws.
/// The step throws:
/// \throws Error (computation_failed) where sweeps do not settle or bodies would pass through one another; the contacts
///         remember
///         what they did
using FlowFunction = void (*)(GrainSystem&);
FlowFunction flow_function(NormalLaw law);

}  // namespace equidem
