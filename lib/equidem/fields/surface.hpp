// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The surface of bodies in a box.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "equidem/grains/scene/clipped_area.hpp"
#include "equidem/grains/scene/grain_scene.hpp"

namespace equidem {

/// The highest point of the bodies in columns of equal width.
struct SurfaceProfile {
  double left = 0, width = 0;   ///< of the first column, m
  std::vector<double> heights;  ///< m; NaN: no body reaches into the column

  /// Middle of a column, m.
  [[nodiscard]] double place(std::size_t column) const { return left + width * (static_cast<double>(column) + 0.5); }
};

/// Exact for every shape: a body counts in a column with the highest point that it has there.
/// \param heap for each body: whether it is included; empty: all are
/// \param columns >= 1, of the width from left to right
SurfaceProfile surface_of(std::span<const Grain> grains, std::span<const Clump> clumps, double left, double right,
                          std::size_t columns, std::span<const char> heap = {});

/// The straight line of least squares through the heights.
struct SurfaceShape {
  double height = 0;     ///< m, mean over the columns
  double slope = 0;      ///< of the line, upwards to the right; 0 for a single column
  double roughness = 0;  ///< m, standard deviation of the heights about the line
};

/// Columns without bodies are left aside.
/// \return NaN where no column has a body
SurfaceShape shape_of(const SurfaceProfile& profile);

/// The heap: the largest set of bodies of which each lies no further than `gap` from another, surface to surface (of
/// ellipses and clumps: of the circles that hold them). \return 1 for a body of the heap \param gap >= 0, m
std::vector<char> heap_of(std::span<const Grain> grains, double gap);

/// The centre of mass of all bodies, m.
Vec2 centre_of_mass(std::span<const Grain> grains);

}  // namespace equidem
