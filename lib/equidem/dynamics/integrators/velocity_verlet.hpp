// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Velocity Verlet: the motion of leapfrog, with velocities at full steps.
#pragma once

#include "equidem/dynamics/integrators/leapfrog.hpp"

namespace equidem::integrators {

inline constexpr IntegrationScheme velocity_verlet{
    .order = leapfrog.order,
    .force_evaluations = leapfrog.force_evaluations,
    .velocities_lag = false,
    .half_step_start = true,
    .limit = leapfrog.limit,
    .stability_limit = leapfrog.stability_limit,
    .stages = leapfrog.stages,
};

}  // namespace equidem::integrators
