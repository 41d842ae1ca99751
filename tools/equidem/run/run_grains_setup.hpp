// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A run of colliding bodies made ready: the case and the step.
#pragma once

#include <cstdint>
#include <string>

#include "equidem/casefile/grains/grain_case.hpp"
#include "equidem/casefile/grains/grain_step.hpp"
#include "equidem/grains/grain_simulation.hpp"

namespace equidem {

struct GrainSetup {
  explicit GrainSetup(GrainCase given);

  GrainCase resolved;
  GrainTimeStep step;
  std::int64_t steps = 0;  ///< number of steps of the whole duration

  /// \throws Error as GrainSimulation does, with its place in the case
  [[nodiscard]] GrainSimulation simulation() const;
  /// The case text in a checkpoint: all data that affect the motion, including files that it names, without how long it
  /// lasts and what is written.
  [[nodiscard]] std::string fingerprint() const;
};

}  // namespace equidem
