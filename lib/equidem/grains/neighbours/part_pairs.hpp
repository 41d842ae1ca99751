// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Pairs of parts of two near bodies that may touch soon.
#pragma once

#include <vector>

#include "equidem/grains/grain_system.hpp"

namespace equidem {

/// Set the parts of all bodies and their axes if the scene has ellipses or clumps.
void place_parts(GrainSystem& system);

/// The parts of two whole discs in a scene with shapes; {} in other scenes. \param j may be an image
PartPair parts_of_discs(const GrainSystem& system, std::int32_t i, std::int32_t j);

/// Update the axes to the present angles of the bodies.
void turn_axes(GrainSystem& system);

/// Upper bound of the displacement of a point of a body by its rotation in the step, m; discs excluded.
double longest_turn(const GrainSystem& system);

/// Pairs of parts that come nearer than the margin, in their order.
std::vector<PartPair> near_parts(const GrainSystem& system, std::size_t i, std::size_t j);
/// Pairs of the parts of a body with a wall that come nearer than the margin; ellipses at a segment by their
/// bounding circle.
std::vector<PartPair> near_parts_of_wall(const GrainSystem& system, std::size_t i, std::size_t wall);

}  // namespace equidem
