// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Steps of a simulation with everything that is written while it runs: energies, frames, histories, checkpoints.
#pragma once

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
#include "equidem/output/files/probes.hpp"

namespace equidem {

/// Something else that is recorded at the moments of the probes, at the start and at the end.
class RunRecorder {
 public:
  virtual ~RunRecorder() = default;
  /// \param continue_after go on with the files of an earlier run: rows later than this step are dropped
  virtual void open(const std::filesystem::path& folder, bool overwrite,
                    std::optional<std::int64_t> continue_after) = 0;
  [[nodiscard]] virtual std::int64_t last_step() const = 0;  ///< -1: none
  virtual void record(std::int64_t step, double time) = 0;
  /// Return once all rows are on the disk.
  virtual void sync() = 0;
};

struct RunPlan {
  std::int64_t steps = 0;  ///< of the whole run
  double time_step = 0;    ///< s
  std::string case_text;   ///< by which a checkpoint is known to belong to this run
  std::optional<double> frame_interval = {}, probe_interval = {};  ///< s of the run; none: no frames, no history
  double checkpoint_interval = 60;                                 ///< s of wall-clock time
  const Assembly* frame_discs = nullptr;                           ///< discs of the frames at the start
  FrameOptions frames = {};                                        ///< but for room and files
  std::vector<Probe> probes = {};
  Body body = Body::disc;      ///< unit of energies
  std::int64_t samples = 200;  ///< of the energies, at least; at most twice as many
  bool paths = false;          ///< places of all bodies at each sample
  RunRecorder* recorder = nullptr;
  /// Checks the energies wherever they are recorded, and between, where `watch_between`. \throws Error
  std::function<void(const EnergyLedger&)> watch = {};
  bool watch_between = false;
  std::string step_place = {};  ///< where the user wrote the time step, for errors of steps; empty: not known
};

struct RunFiles {
  std::optional<std::filesystem::path> folder;  ///< none: nothing is written
  bool overwrite = false;
  bool resume = false;
};

struct RunResult {
  double seconds = 0;           ///< that steps took
  std::int64_t steps_done = 0;  ///< in this call, without those before a checkpoint
  RunRecord record;             ///< from the start of the run
};

/// Make all steps. Writes frames.h5, history.csv and run.checkpoint.h5 on their schedules; progress on stderr. An
/// interrupt leaves a checkpoint, and so does a step that cannot be made. A run that is resumed writes the same files
/// as one that was never stopped.
/// \throws Error as the writers, the watch, advance() and stop_if_interrupted; (bad_input) where a checkpoint lies past
///         the end
RunResult run_through(AnySimulation& simulation, const RunPlan& plan, const RunFiles& files);

/// Seconds that all steps will take, from the time of the first few, which are made.
/// \throws Error as advance()
double estimate_seconds(AnySimulation& simulation, const RunPlan& plan);

}  // namespace equidem
