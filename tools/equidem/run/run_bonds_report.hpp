// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Report of `equidem run` on bonds; empty if there are none.
#pragma once

#include <string>

#include "equidem/grains/grain_simulation.hpp"
#include "equidem/output/files/json.hpp"

#include "run/run_grains_setup.hpp"

namespace equidem {

/// Number of bonds, their integration over a step, the step limit.
std::string describe_bonds(const GrainSetup& setup);
/// Deformation of the bonds since the start.
std::string describe_drift_of_bonds(const BondReport& bonds);

/// bonds {number, critical_time_step (null: none), distance_drift, slip_drift, roll_drift {largest, mean}}.
void add_bonds(JsonObject& object, const GrainSetup& setup, const BondReport& bonds);

}  // namespace equidem
