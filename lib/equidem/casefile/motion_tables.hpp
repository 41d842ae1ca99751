// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Binding of the tables that the runs of bonded and of colliding bodies share.
#pragma once

#include <string>
#include <vector>

#include "equidem/casefile/engine/bind.hpp"
#include "equidem/casefile/motion_case.hpp"
#include "equidem/motion/ledger.hpp"

namespace equidem::casefile {

std::vector<Key<ScheduleTable>> schedule_keys();
/// Bonded discs meet lines with a spring kN; colliding bodies meet all shapes, which may be shaken.
std::vector<Key<WallTable>> wall_keys(BodyFamily family);
/// Both families have the same keys; the quantities are those of the family, the first is the default.
std::vector<Key<Probe>> probe_keys(BodyFamily family);

/// The keys of [run] that both families have, bound to an S that is a RunTable.
/// \param automatic how a step that is not given is chosen
template <class S>
std::vector<Key<S>> run_keys(const std::string& end, const std::string& automatic) {
  return {key_in<S>("duration", &RunTable::duration, unit("s"), positive, "length of the run" + end),
          key_in<S>("time_step", &RunTable::given_step, or_auto, unit("s"), positive, "auto: " + automatic),
          key_in<S>("gravity", &RunTable::gravity, unit("m/s²"), "such as [0.0, -9.81]")};
}

/// Bind [[schedule]], [[wall]] and [[probe]] in a file of an F that is a MotionTables.
template <class F>
void bind_motion(File<F>& file, BodyFamily family) {
  file.table("schedule", &MotionTables::schedule_tables,
             "how a motion or load changes in a run; without one it acts from the start")
      .keys(schedule_keys());
  file.table("wall", &MotionTables::wall_tables, "a wall of infinite mass, in a run").keys(wall_keys(family));
  file.table("probe", &MotionTables::probe_tables, "a history of some bodies in a run").keys(probe_keys(family));
}

}  // namespace equidem::casefile
