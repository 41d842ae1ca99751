// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Events at regular intervals of a run.
/// Loop over the steps of a simulation that writes energies, frames, histories and checkpoints.
#pragma once

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/motion/any_simulation.hpp"
#include "equidem/output/files/checkpoint.hpp"
#include "equidem/output/files/frames.hpp"
#include "equidem/output/files/histories.hpp"

namespace equidem {

/// Steps of events at a regular interval in s of the run, each nearest to its time; no events without an interval.
class Recurrence {
 public:
  Recurrence(std::optional<double> interval, double step) : interval_(interval.value_or(0) / step) {}
  /// The first such step after `step`.
  [[nodiscard]] std::int64_t after(std::int64_t step) const {
    if (!(interval_ > 0)) return never;
    if (interval_ <= 1) return step + 1;
    const double turn = std::ceil((static_cast<double>(step) + 0.5) / interval_ - 1e-9);
    double next = std::floor(turn * interval_ + 0.5);
    if (next <= static_cast<double>(step)) next = std::floor((turn + 1) * interval_ + 0.5);
    return next < 1e18 ? static_cast<std::int64_t>(next) : never;
  }
  [[nodiscard]] bool at(std::int64_t step) const { return step == 0 || (step > 0 && after(step - 1) == step); }
  static constexpr std::int64_t never = INT64_MAX;

 private:
  double interval_;
};

/// Additional record, written at the times of the probes, at the start and at the end.
class RunRecorder {
 public:
  virtual ~RunRecorder() = default;
  /// \param from continue the files of an earlier run from here; null: a new run
  virtual void open(const std::filesystem::path& folder, bool overwrite, const Checkpoint* from) = 0;
  [[nodiscard]] virtual std::int64_t last_step() const = 0;  ///< -1: none
  /// \param regular false: only because the run ends
  virtual void record(std::int64_t step, double time, bool regular) = 0;
  /// Sync all rows to disk, and add to a checkpoint what open() needs.
  virtual void save(Checkpoint& checkpoint) = 0;
};

struct RunPlan {
  std::int64_t steps = 0;                                          ///< of the whole run
  double time_step = 0;                                            ///< s
  std::string case_text;                                           ///< identifies the run of a checkpoint
  std::optional<double> frame_interval = {}, probe_interval = {};  ///< s of the run; none: no frames, no history
  double checkpoint_interval = 60;                                 ///< s of wall-clock time
  const Assembly* frame_discs = nullptr;                           ///< discs of the frames at the start
  FrameOptions frames = {};                                        ///< options of frames, except files
  std::vector<Probe> probes = {};
  std::vector<std::string> walls = {};  ///< names of all walls that the run has at some time
  /// Names what has ended at a milestone: run.NAME.checkpoint.h5 keeps the state there.
  std::function<std::string()> milestone_name = {};
  bool cell = false;             ///< the history has the periodic cell
  Body body = Body::disc;        ///< unit of energies
  std::int64_t samples = 200;    ///< of the energies, at least; at most twice as many
  bool paths = false;            ///< record the positions of all bodies at each sample
  std::int64_t film_frames = 0;  ///< of RunRecord::film, at most but for the last; 0: none
  RunRecorder* recorder = nullptr;
  /// Checks the energies whenever they are recorded, and in between if `watch_between`. \throws Error
  std::function<void(const EnergyLedger&)> watch = {};
  bool watch_between = false;
  std::string step_place = {};  ///< place of the time step in the user's input, for error messages; empty: not known
};

struct RunFiles {
  std::optional<std::filesystem::path> folder;  ///< none: nothing is written
  bool overwrite = false;
  bool resume = false;
};

struct RunResult {
  double seconds = 0;           ///< wall-clock seconds of the steps
  std::int64_t steps_done = 0;  ///< in this call, without those before a checkpoint
  RunRecord record;             ///< from the start of the run
};

/// Perform all steps. Writes frames.pvd, history.csv and run.checkpoint.h5 on their schedules; progress on stderr. A
/// checkpoint is also written at the start, at an interrupt and when a step fails, and at a milestone another one that
/// stays. A run that is resumed writes the same files as one that was never stopped, or that was killed at any moment.
/// \param result as far as the run goes, also where it throws
/// \throws Error as the writers, the watch, advance() and stop_if_interrupted; (bad_input) where a checkpoint lies past
///         the end, or a file that it counts on was altered: then no file is changed
void run_through(AnySimulation& simulation, const RunPlan& plan, const RunFiles& files, RunResult& result);

/// Estimate of the wall-clock seconds of all steps, from the first few steps, which are performed.
/// \throws Error as advance()
double estimate_seconds(AnySimulation& simulation, const RunPlan& plan);

}  // namespace equidem
