// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Results and the plot of `equidem run` that are common to all bodies.
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "equidem/output/plots/plot.hpp"

#include "run/run_job.hpp"

namespace equidem {

/// Steps and their estimated wall-clock seconds, bytes per body; the time step. The first steps are performed.
Results dry_run_results(RunJob& job);

/// time_step, ...; steps, time, energy {terms, elastic, dissipated, input, error, relative_error},
/// particle_steps_per_second, bytes_per_disc or bytes_per_grain, and the results of the job.
Results run_results(RunJob& job, const RunPlan& plan, const RunResult& result);

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
