// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A run that is ready to start: what bonded discs and colliding bodies each add to the common run.
#pragma once

#include <filesystem>
#include <string>

#include "equidem/casefile/assembly/case.hpp"
#include "equidem/core/stopwatch.hpp"
#include "equidem/output/files/json.hpp"
#include "equidem/output/run/run_loop.hpp"

namespace equidem {

/// Beyond this share of the largest energy the error of the balance puts the motion in doubt.
inline constexpr double balance_to_doubt = 0.1;

/// Error of the energy balance over the largest energy of the whole run.
struct Balance {
  double now = 0, most = 0;
};

class RunJob {
 public:
  virtual ~RunJob() = default;

  [[nodiscard]] virtual AnySimulation& simulation() = 0;
  [[nodiscard]] virtual RunPlan plan() = 0;
  [[nodiscard]] virtual const OutputCase& output() const = 0;
  [[nodiscard]] virtual const char* body_name() const = 0;  ///< "disc", "grain"
  /// Seconds of the stages before the run.
  [[nodiscard]] virtual StageTimes times() const { return {}; }

  /// Lines of the report: scene, effects, step.
  [[nodiscard]] virtual std::string describe() const = 0;
  /// Events of the run other than energies.
  [[nodiscard]] virtual std::string describe_events() const { return {}; }
  /// Advice on the energy balance.
  [[nodiscard]] virtual std::string describe_balance(const Balance& balance) const = 0;
  /// The time step and the limits that it keeps.
  virtual void add_step(JsonObject& object) const = 0;
  /// The scene, and what happened besides energies.
  virtual void add_results(JsonObject& object) const = 0;
  /// The state at the end, plots, the case.
  virtual void write_files(const std::filesystem::path& folder, const RunResult& result, bool overwrite) const = 0;
};

}  // namespace equidem
