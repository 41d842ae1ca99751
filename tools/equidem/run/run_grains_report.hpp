// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The part of the report and the JSON of `equidem run` that colliding bodies alone have.
#pragma once

#include <string>

#include "equidem/grains/grain_simulation.hpp"
#include "equidem/output/files/json.hpp"

#include "run/run_grains_setup.hpp"
#include "run/run_job.hpp"

namespace equidem {

/// Bodies, walls, effects, contacts, step.
std::string describe_grains(const GrainSetup& setup, const GrainSimulation& simulation);
/// Advice on the energy balance, and on contacts that were doubtful.
std::string describe_grain_balance(const GrainSetup& setup, const GrainSimulation& simulation, const Balance& balance);

/// time_step, contact_duration, steps_in_contact, omega_time_step, critical_time_step; null where unknown.
void add_grain_step(JsonObject& object, const GrainTimeStep& step);
/// title, grains, walls, body, law, bonds, contacts (begun), touching, evaluations, ...
void add_grain_results(JsonObject& object, const GrainSetup& setup, const GrainSimulation& simulation);

}  // namespace equidem
