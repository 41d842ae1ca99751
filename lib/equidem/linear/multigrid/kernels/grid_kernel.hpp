// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Inner loops on grids, compiled for the vectors that the processor has.
#pragma once

#include <cstddef>

#include "equidem/linear/multigrid/block_matrix.hpp"

namespace equidem::multigrid {

/// A point in its cell, in spacings.
struct Inside {
  float s, t;
};

/// Points of a cell whose four nodes are kept. Its motions are those of the linked interpolation (grid.hpp), with e.g.
/// w = a theta
///   u_x = bilinear(U_x) - h_y/2 t (1 - t) (w_below - w_above)
///   u_y = bilinear(U_y) + h_x/2 s (1 - s) (w_left - w_right)
/// where w is linear along each side.
struct PointsOfCell {
  const Inside* inside;
  std::size_t count;
  float half_x, half_y;  ///< half of the spacings
};

struct GridFunctions {
  /// Forces on the four corners of the same work as those on the points.
  void (*restrict_cell)(const PointsOfCell& points, const Quad* force, Quad* corners);
  /// Add the motions that the corners give.
  void (*move_points)(const PointsOfCell& points, const Quad* corners, Quad* motion);
  /// matrix += k v v^T + l w w^T, 12 x 12.
  void (*add_squares)(double k, const double* v, double l, const double* w, double* matrix);
  /// matrix += T^T K T, all 12 x 12.
  void (*add_projection)(const double* k, const double* t, double* matrix);
};

const GridFunctions& grid_functions();

}  // namespace equidem::multigrid
