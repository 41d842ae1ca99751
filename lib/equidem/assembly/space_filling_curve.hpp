// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Order of points along a space-filling curve: neighbours in space become neighbours in memory.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "equidem/core/vector.hpp"

namespace equidem {

/// The indices of finite points in the order in which Hilbert's curve (Hilbert 1891) of 2^16 x 2^16 cells, over the
/// square from the lowest corner of the points to the larger of their two extents, passes them; points in one cell
/// follow each other by x, then y, then index, so that equal points are neighbours.
std::vector<std::int32_t> hilbert_order(std::span<const Vec2> points);

}  // namespace equidem
