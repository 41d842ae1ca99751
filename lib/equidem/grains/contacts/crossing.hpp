// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Detection of steps in which bodies would pass through one another.
#pragma once

#include "equidem/grains/grain_system.hpp"

namespace equidem {

/// \param reach longest displacement in the step, m
/// \throws Error (computation_failed) if it is not finite
void refuse_runaway(const GrainSystem& system, double reach);

/// In a periodic cell the pairs to look at grow with the square of the way that bodies may move in a step.
/// \param reach longest displacement in the step, m
/// \throws Error (computation_failed) if it is longer than the smallest radius in a periodic cell
void refuse_long_ways_in_cell(const GrainSystem& system, double reach);

/// Whether bodies move so far, or overlap so deeply, that refuse_crossings() has to look.
bool may_cross(const GrainSystem& system, double reach);

/// Where bodies have been moved in place: set `motions` to their places before the step, `next` to those behind it.
void find_places_before(GrainSystem& system);

/// Compare system.bodies.motions with system.bodies.next.
/// \throws Error (computation_failed) if the centre of a grain enters another grain or passes a wall, or an overlap
///         deeper than half the smaller radius would occur undetected between the two instants
void refuse_crossings(const GrainSystem& system);

}  // namespace equidem
