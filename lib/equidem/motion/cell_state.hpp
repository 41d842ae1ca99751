// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A periodic cell of a simulation at its time.
#pragma once

#include <string>
#include <vector>

#include "equidem/core/vector.hpp"

namespace equidem {

/// How well a periodic cell has kept a stress.
struct CellServoReport {
  std::string component;  ///< "xx" or "yy"
  bool reached = false;   ///< the stress has come within 1 % of the wanted one; before, the last two mean nothing
  double wanted = 0;      ///< Pa, in the last step
  double stress = 0;      ///< likewise
  double overshoot = 0;   ///< largest excess of the stress since then, over the largest wanted so far; NaN: it was 0
  double mean_error = 0;  ///< mean of the absolute difference since then, over the same
};

struct CellState {
  double width = 0, height = 0;  ///< m
  double shift = 0;              ///< of the images above against the cell along x, m; within half a width either way
  Voigt strain;                  ///< integral of the rates since the start: ln of the stretches, and of the shear rate
  /// Mean stress, tension positive: -(1/area) times the sum of f_i l_j over the contacts and m u_i u_j over the bodies.
  Tensor2 stress;
  double void_ratio = 0;           ///< area of the cell over that of the discs, less 1
  double coordination_number = 0;  ///< mean contacts of a disc
  std::vector<CellServoReport> servos;

  [[nodiscard]] double area() const { return width * height; }
};

}  // namespace equidem
