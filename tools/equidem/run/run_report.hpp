// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// What `equidem run` says: report, JSON, plot of the energies.
#pragma once

#include <filesystem>
#include <string>

#include "equidem/dynamics/relaxation.hpp"
#include "equidem/output/files/json.hpp"

#include "run/run_loop.hpp"
#include "run/run_setup.hpp"

namespace equidem {

RelaxationOptions relaxation_options(const RunSetup& setup);

/// Assembly, springs, effects, loop and step.
std::string describe_run_setup(const RunSetup& setup, const Simulation& simulation);
/// Steps, speed, energies and their balance.
std::string describe_run(const RunSetup& setup, const Simulation& simulation, const RunResult& result,
                         const StageTimes& times);
/// Seconds that all steps will take, from the time of the first few, which are made.
double estimate_seconds(const RunSetup& setup, Simulation& simulation);
std::string describe_estimate(const RunSetup& setup, double seconds);
std::string describe_rest(const RunSetup& setup, const Relaxation& rest, const StageTimes& times);

/// time_step, critical_time_step, time_step_ratio, time_step_rule, omega_max.
void add_time_step(JsonObject& object, const TimeStep& step);
/// steps, force_evaluations, relative_unbalanced_force, and what was relaxed.
void add_rest(JsonObject& object, const RunSetup& setup, const Relaxation& rest);
/// steps, energy {kinetic, elastic, potential, dissipated, input, error, ...}, particle_steps_per_second, ...
void add_run(JsonObject& object, const RunSetup& setup, const Simulation& simulation, const RunResult& result);

/// energy.{csv,gp,svg,png}: the terms of the ledger against time, and what the balance lacks.
void write_energy_plot(const std::filesystem::path& folder, const RunSetup& setup, const RunResult& result,
                       bool overwrite);

}  // namespace equidem
