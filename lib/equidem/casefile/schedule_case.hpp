// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// [[schedule]]: values that change with time, by name.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "equidem/casefile/engine/toml.hpp"
#include "equidem/motion/schedule.hpp"

namespace equidem {

struct NamedSchedule {
  std::string name;
  Schedule schedule;
};

/// [[schedule]]: a name for a schedule, whose points may be in a file.
struct ScheduleTable {
  std::string name;
  Schedule schedule{.kind = Schedule::Kind::ramp, .value = 1};
  std::optional<std::filesystem::path> path;
};

/// The schedules of a document, checked, with the points of their files.
/// \param root checked; the list [[schedule]] that the tables were read from
/// \throws Error (bad_input) with line and key: an end before the start, points that are missing or do not ascend, a
///         file that is not a table of two columns
std::vector<NamedSchedule> read_schedules(const TomlValue& root, const std::vector<ScheduleTable>& tables);

/// The rows "time,value" of a file as the points of a table; '#' begins a comment.
/// \param column name of the second column in an optional header row
/// \throws Error (bad_input) with file and line: a row that is not two numbers, times that do not ascend, no rows
void read_points(const std::filesystem::path& path, Schedule& table, std::string_view column);

/// `value` times the schedule that the table names; constant if it names none.
/// \param key of the table, for errors: "load"
/// \throws Error (bad_input) if there is no schedule of that name
Schedule scheduled(const TomlValue& table, const std::string& key, double value,
                   std::span<const NamedSchedule> schedules);

}  // namespace equidem
