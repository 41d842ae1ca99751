// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Which parts of two near bodies may touch soon.
#pragma once

#include <vector>

#include "equidem/grains/grain_system.hpp"

namespace equidem {

/// Fill in the parts of all bodies and their axes where the scene has ellipses or clumps; else nothing.
void place_parts(GrainSystem& system);

/// Turn the axes to where the bodies are.
void turn_axes(GrainSystem& system);

/// How far a point of a body is carried by its turning in the step, at most, m; discs aside.
double longest_turn(const GrainSystem& system);

/// Pairs of parts that come nearer than the margin, in their order.
std::vector<PartPair> near_parts(const GrainSystem& system, std::size_t i, std::size_t j);
/// The same of a body and a wall; of ellipses at a segment or an arc by their circle.
std::vector<PartPair> near_parts_of_wall(const GrainSystem& system, std::size_t i, std::size_t wall);

}  // namespace equidem
