// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// [run] and what acts in a run alone: schedules of supports and loads, walls, velocities, probes.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "equidem/casefile/schedule_case.hpp"
#include "equidem/casefile/toml.hpp"
#include "equidem/dynamics/simulation.hpp"
#include "equidem/dynamics/time_step.hpp"

namespace equidem {

/// [[probe]]: a history of a group of discs.
struct ProbeCase {
  std::string name;
  std::string group;
  std::vector<std::string> quantities;  ///< words of the key probe.quantities
};

/// [run]; exactly one of duration and until_rest is given.
struct RunCase {
  std::optional<double> duration;    ///< s
  std::optional<double> until_rest;  ///< unbalanced force, relative
  TimeStepOptions time_step;
  Integrator integrator = Integrator::leapfrog;
  LoopKind::Motion motion = LoopKind::Motion::small;
  Vec2 gravity;  ///< m/s²
  Damping damping;
  std::vector<TimedSupport> supports;  ///< those of the case with their schedules; empty with [test], as loads
  std::vector<TimedLoad> loads;
  std::vector<Wall> walls;
  std::vector<InitialVelocity> velocities;
  std::vector<ProbeCase> probes;
};

/// \param root seen by check_and_complete, with names checked
/// \param schedules, supports of the case
/// \param loads of its first load case; where [run] is given there is one
/// \throws Error (bad_input) with line and key: both or neither of duration and until_rest, a time step longer than the
///         run, two kinds of dashpots, a schedule that does not exist, a wall without a normal, what acts in a run
///         alone where there is none, several load cases (a run is one motion)
std::optional<RunCase> read_run(const TomlValue& root, std::span<const NamedSchedule> schedules,
                                std::span<const Support> supports, std::span<const Load> loads);

}  // namespace equidem
