// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Detection of unstable runs, between chunks of steps.
#pragma once

#include <cstdint>
#include <string>

#include "equidem/dynamics/simulation.hpp"

namespace equidem {

/// Criteria of a runaway and data on its likely cause.
struct RunawayLimits {
  /// Limit of kinetic and elastic energy over all energy supplied (start, loads, supports, walls, gravity); a run above
  /// it is a runaway. In a stable run the ratio is a small multiple of 1 at most.
  double growth = 100;
  double critical_step = 0;  ///< s; 0: not known
  double growth_rate = 0;    ///< 1/s, of motions that grow for any step
};

/// Checks a run between chunks and stops it if motions are not finite, energy is created, or bonded discs in finite
/// motion pass through each other, which the law of a bond does not prevent.
class RunawayWatch {
 public:
  /// The scene must outlive the watch.
  explicit RunawayWatch(const Scene& scene, const SimulationOptions& options, const RunawayLimits& limits = {});

  /// Must be called at the start and after every chunk of steps.
  /// \throws Error (computation_failed) naming the step, the disc with the largest motion and the likely cause
  void look(const Simulation& run, const EnergyLedger& energy);
  void look(const Simulation& run) { look(run, run.energy()); }

 private:
  [[noreturn]] void stop(const Simulation& run, std::int64_t disc, const std::string& problem) const;
  void check_bonds(const Simulation& run) const;
  [[nodiscard]] std::string where(const Simulation& run, std::int64_t disc) const;

  const Scene& scene_;
  SimulationOptions options_;
  RunawayLimits limits_;
  double given_ = 0;  // largest energy supplied so far, N
  std::int64_t last_good_step_ = 0;
};

}  // namespace equidem
