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
#include "equidem/output/checkpoint.hpp"
#include "equidem/output/frames.hpp"
#include "equidem/output/probes.hpp"

#include "run_setup.hpp"

namespace equidem {

struct RunFiles {
  std::optional<std::filesystem::path> folder;  ///< none: nothing is written
  bool overwrite = false;
  bool resume = false;
};

/// Energies at a moment, for the plot of the balance.
struct EnergySample {
  double time = 0;  ///< s
  EnergyLedger ledger;
};

struct RunResult {
  double seconds = 0;                  ///< that steps took
  std::int64_t steps_done = 0;         ///< in this call, without those before a checkpoint
  std::vector<EnergySample> energies;  ///< about two hundred
  std::vector<std::filesystem::path> files;
};

/// Make all steps of a run; frames, histories and checkpoints on their schedules, progress on stderr, a look for
/// runaways between.
/// An interrupt leaves a checkpoint.
/// \throws Error as the writers, the watch and stop_if_interrupted
RunResult run_through(const RunSetup& setup, Simulation& simulation, const RunFiles& files);

}  // namespace equidem
