// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Time step, scene and options of a simulation from the case.
#pragma once

#include <cstdint>

#include "equidem/casefile/grains/grain_case.hpp"
#include "equidem/grains/scene/grain_time_step.hpp"

namespace equidem {

/// \throws Error (bad_input) as choose_time_step, with line and key
GrainTimeStep choose_grain_step(const GrainCase& resolved);

/// Number of steps of the whole duration.
/// \throws Error (bad_input) as count_steps(double, double), with line and key
std::int64_t count_steps(const GrainCase& resolved, double step);

GrainScene build_grain_scene(const GrainCase& resolved, double step);
GrainOptions grain_options(const GrainCase& resolved, double step);

}  // namespace equidem
