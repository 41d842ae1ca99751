// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The tables of a run that bonded and colliding bodies share: [run], [[schedule]], [[wall]], [[probe]].
#pragma once

#include <filesystem>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "equidem/casefile/engine/toml.hpp"
#include "equidem/motion/probe.hpp"
#include "equidem/motion/schedule.hpp"
#include "equidem/motion/wall.hpp"

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

/// By default an arc is a full circle.
inline Wall full_circle() {
  Wall wall;
  wall.to = 2 * std::numbers::pi;
  return wall;
}

/// [[wall]].
struct WallTable {
  Wall wall = full_circle();
  std::optional<double> displacement;  ///< m, along `direction`
  std::optional<Vec2> direction;       ///< none: the normal of a line
  std::optional<std::string> schedule;
  bool shaken = true;  ///< colliding bodies
};

/// The keys of [run] that both families have.
struct RunTable {
  std::optional<double> duration;    ///< s
  std::optional<double> given_step;  ///< s; none: chosen
  Vec2 gravity;                      ///< m/s²
};

/// The tables of a case of either family.
struct MotionTables {
  std::vector<ScheduleTable> schedule_tables;
  std::vector<WallTable> wall_tables;
  std::vector<Probe> probe_tables;
};

/// The schedules of a document, checked, with the points of their files.
/// \param root checked; the list [[schedule]] that the tables were read from
/// \throws Error (bad_input) with line and key: two schedules of one name, an end before the start, points that are
///         missing or do not ascend, a file that is not a table of two columns
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

/// The walls of a document with their motion.
/// \throws Error (bad_input) with line and key: two walls of one name, a normal or direction of length 0, a segment or
///         an arc that `check` refuses, a displacement without a schedule or without a direction, and the reverse
std::vector<Wall> read_walls(const TomlValue& root, const std::vector<WallTable>& tables,
                             std::span<const NamedSchedule> schedules);

/// Refuse the former word "energy" among the quantities of probes; before the document is checked against its keys.
/// \throws Error (bad_input) with its line
void refuse_energy_of_probes(const TomlValue& root);

/// Check the probes of a document by themselves.
/// \throws Error (bad_input) with line and key: two probes of one name, a name that is not plain, neither or both of
///         group and bodies
void check_probes(const TomlValue& root);

/// Check that the bodies that a probe names are there.
/// \param table of the probe
/// \throws Error (bad_input) with line and key
void check_bodies(const TomlValue& table, const Probe& probe, std::size_t bodies);

/// \throws Error (bad_input) if the time step is longer than the run
void check_step(const TomlValue& run, const RunTable& read);

}  // namespace equidem
