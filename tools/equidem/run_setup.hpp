// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A run made ready: what moves, what acts on it, and the step.
#pragma once

#include <string>

#include "equidem/casefile/case.hpp"
#include "equidem/dynamics/simulation.hpp"
#include "equidem/dynamics/time_step.hpp"

#include "problem.hpp"

namespace equidem {

/// Stays where it is: the scene refers to the problem.
struct RunSetup {
  explicit RunSetup(Case resolved);
  RunSetup(const RunSetup&) = delete;
  RunSetup& operator=(const RunSetup&) = delete;

  Problem problem;
  Scene scene;
  TimeStep step;
  SimulationOptions options;

  [[nodiscard]] const RunCase& run() const { return *problem.resolved.run; }
  /// \throws Error as Simulation does, with its place in the case
  [[nodiscard]] Simulation simulation() const;
  /// Steps of the whole duration; 0 where the run goes to rest.
  /// \throws Error (bad_input) where they are too many to be counted
  [[nodiscard]] std::int64_t steps() const;
  /// The case as a checkpoint knows it: all that changes the motion, files that it names too, without how long it lasts
  /// and what is written.
  [[nodiscard]] std::string fingerprint() const;
};

}  // namespace equidem
