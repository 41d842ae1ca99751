// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Stages, servo walls and shaking in the results of a run of colliding bodies.
#pragma once

#include <string>
#include <vector>

#include "equidem/casefile/grains/grain_case.hpp"
#include "equidem/output/results.hpp"

namespace equidem {

/// "2 m/s² (200 gal) at most along (1, 0), 10 Hz, 2 cycles from 0 s to 0.2 s".
std::string describe(const Shaking& shaking);
Results shaking_results(const Shaking& shaking);

/// stages: a list with name, start, end, steps, ended_by, effects; removed, renamed, added, bonds_made, renamed_walls
/// (from, to) where there are some; what it was to end by, and its shaking.
Results stage_results(const GrainCase& resolved, const std::vector<StageReport>& stages, double step);

/// servos: a list with wall, mirror, wanted, force, overshoot, mean_error, and stage where there are some.
/// \param present of the last stage
Results servo_results(const GrainCase& resolved, const std::vector<StageReport>& stages,
                      const std::vector<ServoReport>& present);

/// cell/servos: a list with component, reached, wanted, stress, overshoot, mean_error, and stage where there are some.
/// \param present of the last stage
Results cell_servo_results(const GrainCase& resolved, const std::vector<StageReport>& stages,
                           const std::vector<CellServoReport>& present);

}  // namespace equidem
