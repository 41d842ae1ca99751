// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/linear/multigrid/smoother.hpp"

namespace equidem::multigrid {

std::vector<ChebyshevStep> chebyshev_steps(int degree, double largest, double range, bool from_zero) {
  const double middle = 0.5 * (largest + largest / range), half = 0.5 * (largest - largest / range);
  double rho = half / middle;
  std::vector<ChebyshevStep> steps{{.keep = 0, .add = static_cast<float>(1 / middle), .from_zero = from_zero}};
  for (int k = 1; k < degree; ++k) {
    const double following = 1 / (2 * middle / half - rho);
    steps.push_back({.keep = static_cast<float>(following * rho),
                     .add = static_cast<float>(2 * following / half),
                     .from_zero = from_zero && k == 1});
    rho = following;
  }
  return steps;
}

}  // namespace equidem::multigrid
