// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Sukegawa (2010), eqs. (3.14) to (3.17) as printed: v' = v + h a, x' = x + (v + v')/2 h.
#pragma once

#include <algorithm>

#include "equidem/dynamics/integrators/scheme.hpp"

namespace equidem::integrators {

/// Order 1; unstable without damping: omega h < min(4 zeta, 1/zeta), zeta of all damping.
inline constexpr IntegrationScheme thesis{
    .order = 1,
    .force_evaluations = 1,
    .limit = StabilityLimit::thesis,
    .mass_damping = MassDamping::one_sided,
    .stability_limit = [](double zeta) { return zeta > 0 ? std::min(4 * zeta, 1 / zeta) : 0.0; },
    .stages =
        [](double h, double alpha) {
          return std::vector<Stage>{
              {.keep = 1 - alpha * h, .kick = h, .drift = h / 2, .drift_before = h / 2, .duration = h}};
        },
};

}  // namespace equidem::integrators
