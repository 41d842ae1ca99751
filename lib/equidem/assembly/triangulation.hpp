// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Delaunay and regular triangulations of points; the source of this header is the only one that uses CGAL.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "equidem/core/vector.hpp"

namespace equidem {

/// An edge with the third corners of the two triangles that share it. The edge itself is named from either end and
/// edges come in any order: both depend on addresses in memory.
struct TriangulationEdge {
  std::int32_t a = 0;
  std::int32_t b = 0;
  std::int32_t left = -1;   ///< of the way from a to b; -1: no triangle there
  std::int32_t right = -1;  ///< likewise
};

/// Edges of the Delaunay triangulation of distinct points, or, where `weights` (m²) are given, of their regular
/// triangulation: the dual of the power diagram, whose cells are the places x with the least |x - p|² - weight.
/// Points on one line give a chain of edges without triangles. A point whose power cell is empty has no edge. Four or
/// more corners on one circle are triangulated in one of the possible ways, the same for the same points in the same
/// order. The decisions are exact (Shewchuk's adaptive idea, in CGAL: Fabri et al. 2000).
/// \param weights one per point, or none
/// \param order the points to triangulate, each once, in the order in which they are inserted: a space-filling curve is
/// fast
std::vector<TriangulationEdge> triangulation_edges(std::span<const Vec2> points, std::span<const double> weights,
                                                   std::span<const std::int32_t> order);

}  // namespace equidem
