// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The events of `equidem quasistatic` as events.csv, from which --resume goes on.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "equidem/breakage/breakage_run.hpp"
#include "equidem/output/files/csv.hpp"

namespace equidem {

/// "N/m" or "Pa" of a load, "m" or "" of a motion.
std::string unit_of_load(DrivenBy driven_by);
std::string unit_of_motion(DrivenBy driven_by);

/// One row for each event, numbers that read back to the same bits.
Table event_table(const EventPath& run, const BreakageScene& scene);
struct StoredEvents {
  std::vector<BreakEvent> events;
  bool cut = false;  ///< whether a last row, cut short, is not among them
};
/// \throws Error (bad_input) where the table is another one, a row was altered, or rows are not numbered on from 0
StoredEvents read_events(const std::filesystem::path& path, const EventPath& run, const BreakageScene& scene);

}  // namespace equidem
