// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Runs that went wrong, seen between chunks of steps.
#pragma once

#include <cstdint>
#include <string>

#include "equidem/dynamics/simulation.hpp"

namespace equidem {

/// What tells a runaway and its likely cause.
struct RunawayLimits {
  /// Kinetic and elastic energy over all that the run was ever given (start, loads, supports, walls, gravity), beyond
  /// which it is a runaway. That of a stable run is within a small multiple of 1.
  double growth = 100;
  double critical_step = 0;  ///< s; 0: not known
  double growth_rate = 0;    ///< 1/s, of motions that grow whatever the step
};

/// Looks at a run from time to time and stops it where motions are no numbers, energy comes from nowhere, or bonded
/// discs of a finite motion pass through each other: the law of a bond does not hinder them.
class RunawayWatch {
 public:
  /// The scene must outlive the watch.
  explicit RunawayWatch(const Scene& scene, const SimulationOptions& options, const RunawayLimits& limits = {});

  /// To be called at the start and after every chunk of steps.
  /// \throws Error (computation_failed) naming the step, the disc that is furthest off and the likely cause
  void look(const Simulation& run, const EnergyLedger& energy);
  void look(const Simulation& run) { look(run, run.energy()); }

 private:
  [[noreturn]] void stop(const Simulation& run, std::int64_t disc, const std::string& problem) const;
  void check_bonds(const Simulation& run) const;
  [[nodiscard]] std::string where(const Simulation& run, std::int64_t disc) const;

  const Scene& scene_;
  SimulationOptions options_;
  RunawayLimits limits_;
  double given_ = 0;  // most energy that was ever there to have, N
  std::int64_t last_good_step_ = 0;
};

}  // namespace equidem
