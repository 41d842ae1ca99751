// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A run made ready: what moves, what acts on it, and the step.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "equidem/casefile/assembly/case.hpp"
#include "equidem/dynamics/simulation.hpp"
#include "equidem/dynamics/time_step.hpp"

#include "problem.hpp"

namespace equidem {

/// The step of a resumed run.
struct KeptStep {
  double step = 0;   ///< s
  std::string rule;  ///< by which it was chosen
};

/// The step that a checkpoint was made with.
/// \throws Error (bad_input) where there is no such file, or it is damaged
KeptStep kept_step(const std::filesystem::path& checkpoint);

/// Stays where it is: the scene refers to the problem.
struct RunSetup {
  /// \param kept takes the place of an automatic step
  explicit RunSetup(Case resolved, const std::optional<KeptStep>& kept = {});
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
  /// The case text in a checkpoint: all data that affect the motion, including files that it names, without how long it
  /// lasts and what is written.
  [[nodiscard]] std::string fingerprint() const;
};

}  // namespace equidem
