// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Holes between discs.
#pragma once

#include <optional>

#include "equidem/assembly/assembly.hpp"

namespace equidem {

/// A circle that no disc reaches into.
struct EmptyCircle {
  Vec2 centre;        ///< m
  double radius = 0;  ///< m
};

/// The largest circle between three discs that no disc reaches into, across the sides of a periodic cell too, in a free
/// assembly inside its box, where it has one. The candidates touch the discs of a triangle of the regular triangulation
/// and lie inside that triangle; where radii differ much a larger circle may touch other three discs.
/// \return none of fewer than three discs, or where no circle finds room
std::optional<EmptyCircle> largest_void(const Assembly& assembly);

}  // namespace equidem
