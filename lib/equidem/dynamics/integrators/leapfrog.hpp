// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Central differences: v(t + h/2) = v(t - h/2) + h a(t), u(t + h) = u(t) + h v(t + h/2).
#pragma once

#include <cmath>

#include "equidem/dynamics/integrators/scheme.hpp"

namespace equidem::integrators {

/// Mass-proportional damping is central and does not change the limit omega h = 2; a contact dashpot (zeta > 0, from
/// relative velocities) is evaluated half a step behind: 2 (sqrt(1 + zeta²) - zeta).
inline constexpr IntegrationScheme leapfrog{
    .order = 2,
    .force_evaluations = 1,
    .velocities_lag = true,
    .half_step_start = true,
    .limit = StabilityLimit::central_differences,
    .stability_limit = [](double zeta) { return 2 * (std::sqrt(1 + zeta * zeta) - zeta); },
    .stages =
        [](double h, double alpha) {
          const double damped = alpha * h;
          return std::vector<Stage>{
              {.keep = (1 - damped / 2) / (1 + damped / 2), .kick = h / (1 + damped / 2), .drift = h, .duration = h}};
        },
};

}  // namespace equidem::integrators
