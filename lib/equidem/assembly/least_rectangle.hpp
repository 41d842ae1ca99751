// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The rectangle of least area that holds all discs: the region of a free sample, which turns with it.
#pragma once

#include <span>

#include "equidem/assembly/assembly.hpp"

namespace equidem {

/// The smallest rectangle that holds all discs with its sides along x and y, m. \param radii empty: points
Rectangle upright_rectangle(std::span<const Vec2> centres, std::span<const double> radii = {});

/// The rectangle of least area that holds all discs, in any direction. Between two directions in which other discs are
/// outermost, width and height are sums of the form c cos(theta - a) + r, whose logarithms are concave: the least area
/// is at the end of such a stretch, where a side lies along an edge of the convex hull of the discs, a common tangent
/// of two of them (for points: Freeman & Shapira 1975). Of rectangles equal up to round-off it is the one in the middle
/// of which the centres lie most nearly in the mean, and, where symmetry leaves several, the one to whose sides
/// the first discs lie nearest. O(n log n). \pre at least one disc
TurnedRectangle least_rectangle(std::span<const Vec2> centres, std::span<const double> radii);

}  // namespace equidem
