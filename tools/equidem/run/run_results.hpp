// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Results, the plot and the histories of `equidem run` that are common to all bodies.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "equidem/output/plots/plot.hpp"

#include "run/run_job.hpp"

namespace equidem {

/// Steps and their estimated wall-clock seconds, bytes per body; the time step. The first steps are performed.
Results dry_run_results(RunJob& job);

/// time_step, ...; steps, time, energy {terms, elastic, dissipated, input, error, relative_error},
/// particle_steps_per_second, bytes_per_disc or bytes_per_grain, and the results of the job.
/// \param failed the run did not come to its end: what then cannot be computed is left out
Results run_results(RunJob& job, const RunPlan& plan, const RunResult& result, bool failed = false);

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

/// The folder that the loop of a run writes its tables into: that of --out, or a temporary one.
class HistoryFolder {
 public:
  /// \param temporary whether tables are wanted where there is no --out
  HistoryFolder(const std::optional<std::filesystem::path>& out, bool temporary);
  ~HistoryFolder();
  HistoryFolder(const HistoryFolder&) = delete;
  HistoryFolder& operator=(const HistoryFolder&) = delete;

  [[nodiscard]] const std::optional<std::filesystem::path>& path() const { return path_; }
  [[nodiscard]] bool is_temporary() const { return temporary_; }
  /// The text of history.csv; empty: none was written.
  [[nodiscard]] std::string history() const;
  /// history/COLUMN and measures_history/COLUMN of the tables that were written, energies/COLUMN of the samples.
  [[nodiscard]] std::vector<ResultArray> arrays(const std::vector<EnergySample>& energies, BodyFamily family,
                                                Body body) const;

 private:
  std::optional<std::filesystem::path> path_;
  bool temporary_ = false;
};

}  // namespace equidem
