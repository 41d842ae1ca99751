// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Displacement of parts of bodies in a step, and detection of ellipses that pass through one another.
#pragma once

#include "equidem/grains/grain_system.hpp"

namespace equidem {

/// Branch from part i to part j, or position of part i if j is a wall, before and after the step.
struct PartWay {
  Vec2 before, after;
  double radius_i = 0, radius_j = 0;  ///< radii of the inscribed circles, m
};

PartWay way_of_parts(const GrainSystem& system, const Candidate& candidate, const PartPair& parts);

/// Whether a part of a pair is an ellipse.
bool has_ellipse(const GrainSystem& system, const Candidate& candidate, const PartPair& parts);

/// The error of two ellipses in the step: one approaches with its centre in the other, the normal of an overlap
/// reverses, an overlap of more than half the smaller short half-axis occurs undetected between the two instants, or
/// one larger than that half-axis occurs without a contact before. \return nullptr: no error
const char* crossing_of_ellipses(const GrainSystem& system, const Candidate& candidate, const PartPair& parts);

}  // namespace equidem
