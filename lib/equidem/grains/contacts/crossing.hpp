// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Displacement of parts of bodies in a step, and detection of ellipses that pass through one another.
///
/// Detection of steps in which bodies would pass through one another.
#pragma once

#include "equidem/grains/grain_system.hpp"

namespace equidem {

/// Branch from part i to part j, or position of part i if j is a wall, before and after the step.
struct PartWay {
  Vec2 before, after;
  double radius_i = 0, radius_j = 0;  ///< radii of the inscribed circles, m
};

PartWay way_of_parts(const GrainSystem& system, const Partners& of);

/// Whether a part of a pair is an ellipse.
bool has_ellipse(const GrainSystem& system, const Partners& of);

/// The error of two ellipses in the step: one approaches with its centre in the other, the normal of an overlap
/// reverses, an overlap of more than half the smaller short half-axis occurs undetected between the two instants, or
/// one larger than that half-axis occurs without a contact before. \return nullptr: no error
const char* crossing_of_ellipses(const GrainSystem& system, const Partners& of);

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
