// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Loads and schedules as commands of LAMMPS.
#pragma once

#include <string>
#include <vector>

#include "equidem/output/export/engine_files.hpp"

namespace equidem {

struct LammpsActions {
  std::string loads;               ///< commands, before those that fix bodies; variable t is the time
  std::string supports;            ///< commands, after all that change forces
  std::vector<EngineFile> tables;  ///< of values of bodies, which the commands read
};

/// A support that follows a schedule u is driven by the force m (u(t + h) - 2 u(t) + u(t - h))/h², with which the step
/// h of LAMMPS puts it into its place.
LammpsActions lammps_actions(const EngineModel& model);

}  // namespace equidem
