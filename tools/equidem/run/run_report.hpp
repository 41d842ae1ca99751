// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The part of the report, the JSON and the plots of `equidem run` that is common to all bodies.
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "equidem/output/plots/plot.hpp"

#include "run/run_job.hpp"

namespace equidem {

Balance balance_of(const EnergyLedger& end, const RunRecord& record);

/// Intervals that the time step does not allow, probes without interval, memory.
std::string describe_output(const RunJob& job, const RunPlan& plan, const AnySimulation& simulation);
/// Steps and speed, job.describe_events(), energies and their balance, times.
std::string describe_run(const RunJob& job, const RunPlan& plan, const AnySimulation& simulation,
                         const RunResult& result, const StageTimes& times);
std::string describe_times(const StageTimes& times);

/// steps, time, energy {terms, elastic, dissipated, input, error, relative_error}, particle_steps_per_second,
/// bytes_per_disc or bytes_per_grain, and what the job adds.
void add_run(JsonObject& object, const RunJob& job, const AnySimulation& simulation, const RunResult& result);

/// "J per m of depth", "J".
const char* energy_unit(Body body);

struct EnergyCurve {
  const char* label;
  PlotColour colour;
  double (*value)(const EnergyLedger&);
};
/// NAME.{csv,gp,svg,png}: curves that are not 0 throughout, and the error of the balance, against time.
void write_energy_plot(const std::filesystem::path& folder, const std::string& name, const std::string& title,
                       Body body, std::span<const EnergySample> energies, std::span<const EnergyCurve> curves,
                       bool overwrite);

}  // namespace equidem
