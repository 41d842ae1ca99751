// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/casefile/motion_case.hpp"

#include <cmath>
#include <string_view>

#include "equidem/casefile/engine/read_value.hpp"
#include "equidem/core/names.hpp"
#include "equidem/core/table_file.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

namespace fs = std::filesystem;
using casefile::fail_at;
using casefile::repeated;

/// \return the key at fault where the schedule is wrong
const char* complete_schedule(const TomlValue& table, ScheduleTable& read) {
  Schedule& schedule = read.schedule;
  if (schedule.kind != Schedule::Kind::table) return schedule.kind == Schedule::Kind::ramp ? "end" : "frequency";
  schedule.value = 0;
  const bool times = table.find("times") != nullptr, values = table.find("values") != nullptr;
  if ((times && values) == read.path.has_value() || times != values) {
    fail_at(table, "schedule", fmt::format("the points of '{}' are not given once", read.name),
            "a table is times and values, or a file", "Give times = [...] and values = [...], or path = \"FILE\"");
  }
  if (!read.path) return "times";
  try {
    read_points(*read.path, schedule, "value");
  } catch (const Error& error) {
    throw error.at(fmt::format("{}: schedule.path", table.find("path")->where()));
  }
  return "path";
}

Vec2 unit_vector(const Vec2& given, const TomlValue& table, const char* key, const std::string& use) {
  const double length = norm(given);
  if (length == 0)
    fail_at(*table.find(key), fmt::format("wall.{}", key),
            fmt::format("the {} of wall '{}' is zero", key, table.find("name")->text), use,
            "Give a direction, such as [0.0, 1.0]");
  return given / length;
}

void set_motion(const TomlValue& table, const WallTable& read, std::span<const NamedSchedule> schedules, Wall& wall) {
  if (!read.displacement || !read.schedule) {
    const char* lonely = read.displacement ? "displacement" : read.schedule ? "schedule" : "direction";
    if (table.find(lonely) == nullptr) return;
    fail_at(*table.find(lonely), fmt::format("wall.{}", lonely),
            fmt::format("wall '{}' has no {}", wall.name, read.displacement ? "schedule" : "displacement"),
            "a wall moves by its displacement times a schedule",
            read.displacement
                ? "Add schedule = \"NAME\" and a [[schedule]] of that name; or place the wall by its point"
                : "Add displacement = ... in m");
  }
  if (!read.direction && wall.shape != Wall::Shape::line)
    fail_at(*table.find("displacement"), "wall.displacement", fmt::format("wall '{}' has no direction", wall.name),
            "only a line has a normal to move along", "Add direction = [..., ...]");
  const Vec2 direction =
      read.direction ? unit_vector(*read.direction, table, "direction", "it says where the wall moves") : wall.normal;
  move_along(wall, direction, scheduled(table, "wall", *read.displacement, schedules));
}

/// The key at fault where a wall is refused.
const char* culprit_of(Wall::Shape shape) {
  switch (shape) {
    case Wall::Shape::line:
      return "normal";
    case Wall::Shape::segment:
      return "end";
    case Wall::Shape::arc:
      break;
  }
  return "to";
}

Wall wall_of(const TomlValue& table, const WallTable& read, std::span<const NamedSchedule> schedules) {
  Wall wall = read.wall;
  if (wall.shape == Wall::Shape::line)
    wall.normal = unit_vector(wall.normal, table, "normal", "it says on which side the bodies are");
  if (wall.shape != Wall::Shape::arc) wall.to = 0;
  const char* culprit = culprit_of(wall.shape);
  try {
    check(wall);
  } catch (const Error& error) {
    throw error.at(fmt::format("{}: wall.{}", table.find(culprit)->where(), culprit));
  }
  set_motion(table, read, schedules, wall);
  return wall;
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
  casefile::check_names(root, "schedule");
  std::vector<NamedSchedule> schedules;
  for (std::size_t k = 0; k < tables.size(); ++k) {
    const TomlValue& table = repeated(root, "schedule")[k];
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
  fail_at(*wanted, key + ".schedule", fmt::format("there is no schedule {}", wanted->shown()),
          schedules.empty() ? "the case has no [[schedule]]"
                            : fmt::format("the case has {}", counted(static_cast<long long>(names.size()), "other")),
          meant ? fmt::format("Did you mean \"{}\"?", *meant) : "Add a [[schedule]] of that name, or correct it");
}

std::vector<Wall> read_walls(const TomlValue& root, const std::vector<WallTable>& tables,
                             std::span<const NamedSchedule> schedules) {
  casefile::check_names(root, "wall");
  std::vector<Wall> walls;
  for (std::size_t k = 0; k < tables.size(); ++k)
    walls.push_back(wall_of(repeated(root, "wall")[k], tables[k], schedules));
  return walls;
}

void refuse_energy_of_probes(const TomlValue& root) {
  for (const TomlValue& table : repeated(root, "probe")) {
    const TomlValue* quantities = table.find("quantities");
    for (std::size_t k = 0; quantities != nullptr && k < quantities->items.size(); ++k)
      if (quantities->items[k].text == "energy")
        fail_at(quantities->items[k], "probe.quantities", "energy is no quantity of a probe",
                "the energies of the whole scene are in every history", "Remove it");
  }
}

void check_probes(const TomlValue& root) {
  casefile::check_names(root, "probe");
  for (const TomlValue& table : repeated(root, "probe")) {
    casefile::check_plain_name(*table.find("name"), "probe.name", "a probe", "it begins the names of columns");
    casefile::check_one_of(table, "probe", {"group", "bodies"}, "it is not said whose history it is",
                           "a probe records a group, or bodies by their numbers", "Give one of the two");
  }
}

void check_bodies(const TomlValue& table, const Probe& probe, std::size_t bodies) {
  for (std::size_t k = 0; k < probe.bodies.size(); ++k) {
    if (static_cast<std::size_t>(probe.bodies[k]) < bodies) continue;
    fail_at(table.find("bodies")->items[k], "probe.bodies", fmt::format("there is no body {}", probe.bodies[k]),
            fmt::format("they are counted 0 to {}", static_cast<long long>(bodies) - 1), "Correct the number");
  }
}

void check_step(const TomlValue& run, const RunTable& read) {
  if (!read.given_step || !read.duration || *read.given_step <= *read.duration) return;
  fail_at(*run.find("time_step"), "run.time_step",
          fmt::format("time_step = {} s is longer than the run of {} s", *read.given_step, *read.duration),
          "a run makes at least one step", "Shorten the step");
}

}  // namespace equidem
