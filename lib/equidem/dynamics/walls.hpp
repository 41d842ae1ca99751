// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Whether walls leave room for the discs.
#pragma once

#include <cstddef>
#include <span>

#include "equidem/assembly/assembly.hpp"
#include "equidem/dynamics/simulation.hpp"

namespace equidem {

/// Check wall k by itself, against the other walls, and against the discs where they start.
///
/// Two walls may cross as the sides of a box do, with all discs inside the corner: no centre of a disc lies behind a
/// wall. Two walls that face each other never touch, at the start or later; where both move that is seen at the turning
/// points of either.
/// \throws Error (bad_input) on a spring that is not positive, a normal that is no unit vector, numbers that are not
///         finite, a periodic assembly (it has no outside), two walls that face each other and cross, a disc behind
void check_wall(std::span<const Wall> walls, std::size_t k, const Assembly& assembly);

/// The same for every wall.
void check_walls(std::span<const Wall> walls, const Assembly& assembly);

}  // namespace equidem
