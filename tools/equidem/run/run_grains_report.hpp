// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// What `equidem run` says of bodies that collide: report, JSON, plot of the energies.
#pragma once

#include <filesystem>
#include <string>

#include "equidem/core/stopwatch.hpp"
#include "equidem/grains/grain_simulation.hpp"
#include "equidem/output/files/json.hpp"

#include "run/run_grains_loop.hpp"

namespace equidem {

/// Bodies, walls, effects, contacts, step.
std::string describe_grains(const GrainSetup& setup, const GrainSimulation& simulation);
/// Steps, speed, contacts, energies and their balance.
std::string describe_grain_run(const GrainSetup& setup, const GrainSimulation& simulation, const GrainRun& run,
                               const StageTimes& times);

/// time_step, contact_duration, steps_in_contact, omega_time_step, critical_time_step; null where unknown.
void add_grain_step(JsonObject& object, const GrainTimeStep& step);
/// title, grains, walls, body, law, steps, time, energy {...}, contacts (begun), touching, evaluations, ...
void add_grain_run(JsonObject& object, const GrainSetup& setup, const GrainSimulation& simulation, const GrainRun& run);

/// energy_plot.{csv,gp,svg,png}: the ledger in a few curves against time, and what the balance lacks.
void write_grain_energy_plot(const std::filesystem::path& folder, const GrainSetup& setup, const GrainRun& run,
                             bool overwrite);

}  // namespace equidem
