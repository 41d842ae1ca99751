// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The position-extended Forest-Ruth-like scheme of Omelyan, Mryglod & Folk (2002): symplectic, order 4. Drifts xi,
/// chi, 1 - 2(chi + xi), chi, xi around kicks (1 - 2 lambda)/2, lambda, lambda, (1 - 2 lambda)/2.
#pragma once

#include <array>
#include <cmath>

#include "equidem/dynamics/integrators/scheme.hpp"

namespace equidem::integrators {
namespace omelyan {

inline constexpr double xi = 0.1786178958448091, lambda = -0.2123418310626054, chi = -0.06626458266981849;
inline constexpr std::array<double, 4> kicks = {0.5 - lambda, lambda, lambda, 0.5 - lambda};
/// Drift after each kick; the last one includes the drift before the first kick of the next step.
inline constexpr std::array<double, 4> drifts = {chi, 1 - 2 * (chi + xi), chi, 2 * xi};

/// Half the trace of the matrix of one step of an oscillator with w = omega h; stable while in [-1, 1].
inline double half_trace(double w) {
  double a = 1, b = 0, c = 0, d = 1;  // (u, v/omega) after = [a b; c d] (u, v/omega) before
  for (std::size_t k = 0; k < kicks.size(); ++k) {
    c -= kicks[k] * w * a;
    d -= kicks[k] * w * b;
    a += drifts[k] * w * c;
    b += drifts[k] * w * d;
  }
  return 0.5 * (a + d);
}

inline double limit() {
  constexpr double step = 1e-3;
  double stable = step;
  while (std::abs(half_trace(stable + step)) <= 1) stable += step;
  double unstable = stable + step;
  while (unstable - stable > 1e-14) {
    const double middle = 0.5 * (stable + unstable);
    (std::abs(half_trace(middle)) <= 1 ? stable : unstable) = middle;
  }
  return stable;
}

/// Mass-proportional damping is exact for constant forces: v' = F/m - alpha v.
inline std::vector<Stage> stages(double h, double alpha) {
  std::vector<Stage> stages;
  for (std::size_t k = 0; k < kicks.size(); ++k) {
    const double part = kicks[k] * (alpha * h);
    const double weight = std::abs(part) > 1e-12 ? -std::expm1(-part) / part : 1.0;
    stages.push_back(
        {.keep = std::exp(-part), .kick = kicks[k] * h * weight, .drift = drifts[k] * h, .duration = kicks[k] * h});
  }
  return stages;
}

}  // namespace omelyan

/// Between steps, motions are stored ahead by the first drift: a step begins and ends with the same short drift, and
/// two successive ones are merged.
inline constexpr IntegrationScheme fourth_order{
    .order = 4,
    .force_evaluations = 4,
    .takes_dashpots = false,
    .mass_damping = MassDamping::exact,
    .stability_limit =
        [](double) {
          static const double limit = omelyan::limit();
          return limit;
        },
    .stages = omelyan::stages,
    .first_drift = omelyan::xi,
};

}  // namespace equidem::integrators
