// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The vector of a cone that lies nearest to a given one.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace equidem {

/// {sum of x_k a_k + y_k b_k} with x_k >= 0 and y_k of either sign.
struct Cone {
  std::vector<std::vector<double>> edges;  ///< a_k
  std::vector<std::vector<double>> lines;  ///< b_k
};

/// The vector less the nearest one of the cone, by least squares with x >= 0 (Lawson & Hanson 1974,
/// Solving Least Squares Problems, ch. 23). With this remainder r of f, r . f = |r|², r . a <= 0 and r . b = 0 for all
/// edges and lines (Farkas): where r is not 0 it proves that f is outside of the cone.
struct ConeRemainder {
  std::vector<double> remainder;
  double share = 0;   ///< |r|/|f|
  double beyond = 0;  ///< the largest a . r/(|a| |r|) and |b . r|/(|b| |r|): round-off where r is a proof
};
ConeRemainder remainder_outside(Cone cone, std::span<const double> f);

}  // namespace equidem
