// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A run that is ready to start: what bonded discs and colliding bodies each add to the common run; results, the plot,
/// the histories and the moving picture that are common to all.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "equidem/casefile/assembly/case.hpp"
#include "equidem/casefile/grains/grain_case.hpp"
#include "equidem/core/stopwatch.hpp"
#include "equidem/output/plots/plot.hpp"
#include "equidem/output/results.hpp"
#include "equidem/output/run/run_loop.hpp"

#include "command.hpp"

namespace equidem {

/// Error of the energy balance over the largest energy.
struct Balance {
  static constexpr double doubtful = 0.1;  ///< beyond it the motion is in doubt
  double at_end = 0;
  double most = 0;  ///< the largest during the run
};

class RunJob {
 public:
  virtual ~RunJob() = default;

  [[nodiscard]] virtual AnySimulation& simulation() = 0;
  [[nodiscard]] virtual RunPlan plan() = 0;
  [[nodiscard]] virtual const char* body_name() const = 0;  ///< "disc", "grain"
  /// Files of --out that are checked before the run, result.json and case.toml apart.
  [[nodiscard]] virtual std::vector<std::string> files() const = 0;
  /// Seconds of the stages before the run.
  [[nodiscard]] virtual StageTimes times() const { return {}; }

  /// Title, bodies, effects, law or integrator.
  [[nodiscard]] virtual Results scene() const = 0;
  /// The time step and the limits that it keeps.
  [[nodiscard]] virtual Results step() const = 0;
  /// Events of the run other than energies.
  [[nodiscard]] virtual Results events() const { return {}; }
  /// Advice on the energy balance.
  [[nodiscard]] virtual Results advice(const Balance& balance) const = 0;
  /// The state at the end, plots, the case. The job and the result must stay where they are.
  [[nodiscard]] virtual std::vector<OutputPart> parts(const RunResult& result) const = 0;

  /// Memory that the picture of the end takes beside the run.
  [[nodiscard]] virtual double bytes_of_drawing() const { return 0; }

  /// Whether the case asks for relaxation in place of steps.
  [[nodiscard]] virtual bool goes_to_rest() const { return false; }
  /// Relax the scene to rest, the state that parts() then write.
  virtual Results relax(StageTimes& /*times*/) { return {}; }
};

/// The run of a case of bonded discs or of bodies that collide.
/// \param resume whether an automatic time step is that of the checkpoint in --out
/// \param begin_from checkpoint with whose state a run of grains begins
/// \throws Error (bad_input) as the readers of the cases, the constructors of the runs, and GrainRun::begin_from
std::unique_ptr<RunJob> make_run_job(const CommonOptions& options, bool resume,
                                     const std::optional<std::filesystem::path>& begin_from = {});

/// Steps and their estimated wall-clock seconds, memory, the time step. The first steps are performed.
/// \param with_files whether the run draws its end
Results dry_run_results(RunJob& job, bool with_files);

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
/// NAME.{csv,gp,svg,png}: kinetic, elastic, potential and further energies that are not 0 throughout, and the error of
/// the balance, against time.
void write_energy_plot(const CommonOptions& into, const std::string& name, const std::string& title, Body body,
                       std::span<const EnergySample> energies, std::span<const EnergyCurve> further);

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

/// The number of frames that a page has room for; 0 where the bodies are too many for any motion to be seen.
std::int64_t frames_of_film(std::size_t bodies);

/// Add the film to the figures of this thread (DrawnFigures), where it has two frames at least. Displacements of bonded
/// discs are enlarged where they are too small to be seen, as in write_picture.
void add_film(const std::string& title, const Assembly& assembly, std::span<const FilmFrame> frames);
/// \param colours of each grain \param started as GrainAnimation
void add_film(const GrainCase& resolved, std::span<const Wall> walls, std::span<const int> colours,
              std::span<const Grain> started, std::span<const FilmFrame> frames);

}  // namespace equidem
