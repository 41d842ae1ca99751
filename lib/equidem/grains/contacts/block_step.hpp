// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The contacts of all blocks of bodies in a step.
#pragma once

#include "equidem/grains/grain_system.hpp"

namespace equidem {

/// Add the impulses of candidates begin .. end, and what they add to sums.
using CandidateLoop = void (*)(GrainSystem& system, std::size_t begin, std::size_t end, BlockSums& sums);

/// Advance the bodies of a block by their impulses.
/// \param free_flight all impulses are known to be zero
using BlockMove = void (*)(GrainSystem& system, std::size_t block, bool free_flight);

/// Whether all candidates are contacts with walls: the impulses on a block are then known before those on later ones.
bool touches_walls_alone(const GrainSystem& system);

/// Set the impulses of all bodies to those of their contacts in this step, and count their sums.
/// \param move of each block, made as soon as its impulses are known, while they are in the cache, if
///        touches_walls_alone(); null: none
void collide_bodies(GrainSystem& system, CandidateLoop loop, BlockMove move);

}  // namespace equidem
