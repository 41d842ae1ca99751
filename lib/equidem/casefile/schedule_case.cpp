// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/casefile/schedule_case.hpp"

#include <cmath>
#include <string_view>

#include "equidem/casefile/engine/read_value.hpp"
#include "equidem/core/names.hpp"
#include "equidem/core/table_file.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

namespace fs = std::filesystem;

/// \return the key at fault where the schedule is wrong
const char* complete_schedule(const TomlValue& table, ScheduleTable& read) {
  Schedule& schedule = read.schedule;
  if (schedule.kind != Schedule::Kind::table) return schedule.kind == Schedule::Kind::ramp ? "end" : "frequency";
  schedule.value = 0;
  const bool times = table.find("times") != nullptr, values = table.find("values") != nullptr;
  if ((times && values) == read.path.has_value() || times != values) {
    casefile::fail_at(table, "schedule", fmt::format("the points of '{}' are not given once", read.name),
                      "a table is times and values, or a file",
                      "Give times = [...] and values = [...], or path = \"FILE\"");
  }
  if (!read.path) return "times";
  try {
    read_points(*read.path, schedule, "value");
  } catch (const Error& error) {
    throw error.at(fmt::format("{}: schedule.path", table.find("path")->where()));
  }
  return "path";
}

}  // namespace

void read_points(const fs::path& path, Schedule& table, std::string_view column) {
  TableFile file(path);
  while (file.next()) {
    const auto& cells = file.cells();
    const bool pair = cells.size() == 2;
    if (file.is_first() && pair && cells[0] == "time" && cells[1] == column) continue;
    const auto time = number_from<double>(cells.front()), value = number_from<double>(cells.back());
    if (!pair || !time || !value || !std::isfinite(*time) || !std::isfinite(*value)) {
      file.fail("this row is not a time and a value", "two numbers with a comma are needed",
                fmt::format("Write it like 0.5,1.0; the first row may be time,{}", column));
    }
    if (!table.times.empty() && *time <= table.times.back()) {
      file.fail(fmt::format("the time {} s comes after {} s", *time, table.times.back()),
                "times ascend, and a value cannot jump", "Order the rows and leave out repeated times");
    }
    table.times.push_back(*time);
    table.values.push_back(*value);
  }
  if (table.times.empty())
    bad_input(fmt::format("'{}' has no points", path.string()), "a table needs at least one", "Add rows like 0.5,1.0");
}

std::vector<NamedSchedule> read_schedules(const TomlValue& root, const std::vector<ScheduleTable>& tables) {
  std::vector<NamedSchedule> schedules;
  for (std::size_t k = 0; k < tables.size(); ++k) {
    const TomlValue& table = casefile::repeated(root, "schedule")[k];
    ScheduleTable read = tables[k];
    const char* culprit = complete_schedule(table, read);
    try {
      check(read.schedule);
    } catch (const Error& error) {
      throw error.at(fmt::format("{}: schedule.{}", table.find(culprit)->where(), culprit));
    }
    schedules.push_back({read.name, std::move(read.schedule)});
  }
  return schedules;
}

Schedule scheduled(const TomlValue& table, const std::string& key, double value,
                   std::span<const NamedSchedule> schedules) {
  const TomlValue* wanted = table.find("schedule");
  if (wanted == nullptr) return Schedule{.value = value};
  std::vector<std::string> names;
  for (const NamedSchedule& known : schedules) {
    if (known.name == wanted->text) return value == 0 ? Schedule{} : scaled(known.schedule, value);
    names.push_back(known.name);
  }
  const auto meant = nearest(wanted->text, names);
  casefile::fail_at(
      *wanted, key + ".schedule", fmt::format("there is no schedule {}", wanted->shown()),
      schedules.empty() ? "the case has no [[schedule]]"
                        : fmt::format("the case has {}", counted(static_cast<long long>(names.size()), "other")),
      meant ? fmt::format("Did you mean \"{}\"?", *meant) : "Add a [[schedule]] of that name, or correct it");
}

}  // namespace equidem
