// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Steps that would let bodies pass through one another.
#pragma once

#include "equidem/grains/grain_system.hpp"

namespace equidem {

/// \param reach the longest way of the step
/// \throws Error (computation_failed) where that is no number
void refuse_runaway(const GrainSystem& system, double reach);

/// Compare system.bodies.motions with system.bodies.next.
/// \throws Error (computation_failed) where the centre of a grain enters another grain or passes a wall, or a geometry
///         deeper than half
///         the smaller radius would lie between the two instants unseen
void refuse_crossings(const GrainSystem& system, double reach);

}  // namespace equidem
