// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// [run] and the tables used only in a run: schedules of supports and loads, walls, velocities, probes.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "equidem/casefile/engine/toml.hpp"
#include "equidem/casefile/motion_case.hpp"
#include "equidem/dynamics/simulation.hpp"
#include "equidem/dynamics/time_step.hpp"

namespace equidem {

/// [run]; exactly one of duration and until_rest is given.
struct RunCase : RunTable {
  std::optional<double> until_rest;  ///< unbalanced force, relative
  TimeStepOptions time_step;
  Integrator integrator = SimulationOptions{}.integrator;
  LoopKind::Motion motion = SimulationOptions{}.motion;
  Damping damping;
  std::vector<TimedSupport> supports;  ///< supports of the case with their schedules; empty with [test], like loads
  std::vector<TimedLoad> loads;
  std::vector<Wall> walls;
  std::vector<InitialVelocity> velocities;
  std::vector<Probe> probes;
};

}  // namespace equidem
