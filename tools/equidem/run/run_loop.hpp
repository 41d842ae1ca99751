// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Steps of a run between the moments at which something is written.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "equidem/dynamics/simulation.hpp"
#include "equidem/dynamics/watch.hpp"
#include "equidem/output/files/checkpoint.hpp"
#include "equidem/output/files/energy_terms.hpp"
#include "equidem/output/files/frames.hpp"
#include "equidem/output/files/probes.hpp"

#include "run/run_setup.hpp"

namespace equidem {

struct RunFiles {
  std::optional<std::filesystem::path> folder;  ///< none: nothing is written
  bool overwrite = false;
  bool resume = false;
};

struct RunResult {
  double seconds = 0;                  ///< that steps took
  std::int64_t steps_done = 0;         ///< in this call, without those before a checkpoint
  std::vector<EnergySample> energies;  ///< 200 to 400, from the start of the run
  std::vector<std::filesystem::path> files;
};

/// Make all steps of a run; frames, histories and checkpoints on their schedules, progress on stderr, a look for
/// runaways between.
/// An interrupt leaves a checkpoint.
/// \throws Error as the writers, the watch and stop_if_interrupted; (bad_input) where a checkpoint lies past the end
RunResult run_through(const RunSetup& setup, Simulation& simulation, const RunFiles& files);

}  // namespace equidem
