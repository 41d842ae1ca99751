// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The way of parts of bodies in a step, and whether ellipses pass through one another on it.
#pragma once

#include "equidem/grains/grain_system.hpp"

namespace equidem {

/// From part i to part j, or of part i alone where j is a wall, before and after the step.
struct PartWay {
  Vec2 before, after;
  double radius_i = 0, radius_j = 0;  ///< of the circles that they hold, m
};

PartWay way_of_parts(const GrainSystem& system, const Candidate& candidate, const PartPair& parts);

/// Whether a part of a pair is an ellipse.
bool has_ellipse(const GrainSystem& system, const Candidate& candidate, const PartPair& parts);

/// What two ellipses would do in the step that they must not: one comes nearer with its centre in the other, the normal
/// of an overlap turns round, an overlap of more than half the smaller short half-axis lies unseen between the two
/// instants, or one of more than all of it comes from none. \return nullptr: nothing
const char* crossing_of_ellipses(const GrainSystem& system, const Candidate& candidate, const PartPair& parts);

/// \throws Error (computation_failed) where the step leads an ellipse to the inside of an arc, within reach of it
void refuse_ellipses_in_bowls(const GrainSystem& system);

}  // namespace equidem
