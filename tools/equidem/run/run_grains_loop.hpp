// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A run of colliding bodies: made ready, and its steps between the moments at which something is written.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "equidem/casefile/grain_case.hpp"
#include "equidem/casefile/grain_step.hpp"
#include "equidem/grains/grain_simulation.hpp"
#include "equidem/output/files/grain_checkpoint.hpp"

#include "run/run_grains_measures.hpp"

namespace equidem {

struct GrainSetup {
  explicit GrainSetup(GrainCase given);

  GrainCase resolved;
  GrainTimeStep step;
  std::int64_t steps = 0;  ///< of the whole duration

  /// \throws Error as GrainSimulation does, with its place in the case
  [[nodiscard]] GrainSimulation simulation() const;
  /// The case as a checkpoint knows it: all that changes the motion, files that it names too, without how long it lasts
  /// and what is written.
  [[nodiscard]] std::string fingerprint() const;
};

struct GrainFiles {
  std::optional<std::filesystem::path> folder;  ///< none: nothing is written
  bool overwrite = false;
  bool resume = false;
};

struct GrainRun {
  double seconds = 0;           ///< that steps took
  std::int64_t steps_done = 0;  ///< in this call, without those before a checkpoint
  GrainRecord record;           ///< 200 to 400 moments, of few grains 1000 to 2000, from the start of the run
};

/// Make all steps; frames, histories and checkpoints on their schedules, progress on stderr. An interrupt leaves a
/// checkpoint, and so does a step that cannot be made.
/// \throws Error as the writers, GrainSimulation::advance and stop_if_interrupted; (bad_input) where a checkpoint lies
///         past the end
/// \param measures recorded at the moments of the probes, at the start and at the end; none: nullptr
GrainRun run_through(const GrainSetup& setup, GrainSimulation& simulation, const GrainFiles& files,
                     GrainMeasures* measures = nullptr);

}  // namespace equidem
