// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Values that change with time: prescribed motions, factors of loads.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "equidem/core/names.hpp"

namespace equidem {

/// A value as a function of time.
struct Schedule {
  enum class Kind {
    constant,  ///< value
    ramp,      ///< from 0 at `start` to value at `end`, smooth (cosine: no jump in velocity), value afterwards
    sine,      ///< value sin(2 pi frequency (t - start)), 0 before start
    table,     ///< linear between points, constant outside
    /// value (1 - cos(2 pi frequency (t - start))) from start to end, a whole number of cycles; 0 outside. The motion
    /// starts and ends at rest; the acceleration is value (2 pi frequency)² cos(...) with full amplitude throughout.
    cycles
  } kind = Kind::constant;
  double value = 0;
  double start = 0;                             ///< s
  double end = 0;                               ///< s, ramp, cycles: > start
  double frequency = 0;                         ///< Hz, sine, cycles: > 0
  std::vector<double> times = {}, values = {};  ///< table: times ascending, at least one

  /// Value at a time, s; bit-identical on every machine.
  [[nodiscard]] double at(double time) const;
  [[nodiscard]] bool changes() const { return kind != Kind::constant; }
  bool operator==(const Schedule&) const = default;
};

/// The kinds that a user chooses from.
template <>
struct EnumNames<Schedule::Kind> {
  using enum Schedule::Kind;
  static constexpr const char* what = "kind of schedule";
  static constexpr NamedValue<Schedule::Kind> list[] = {{ramp, "ramp"}, {sine, "sine"}, {table, "table"}};
};

/// \throws Error (bad_input) on numbers that are not finite, an end before the start, a frequency that is not positive,
///         a fractional number of cycles, times that do not ascend
void check(const Schedule& schedule);

/// The part of a schedule that sampling at time steps misses.
struct MissedEvent {
  double share = 0;  ///< missed share of the range of the values, in [0, 1]
  double time = 0;   ///< s
};

/// The largest share of a schedule's range that steps of a given length miss within a run. Values between two
/// successive steps count as covered if they lie between the values at these steps. Missed are a point of a table that
/// stands out and the peaks of a sine or of cycles (all of them below two steps a period); a jump is not missed. \param
/// step, end s
MissedEvent missed_event(const Schedule& schedule, double step, double end);

/// Number of steps of the whole duration.
/// \param duration, step s
/// \throws Error (bad_input) if there are more than 1e15
std::int64_t count_steps(double duration, double step);

/// The schedule multiplied by a factor.
Schedule scaled(Schedule schedule, double factor);

/// Append the rows "time,value" of a file to the points of a table; '#' begins a comment.
/// \param column name of the second column in an optional header row
/// \throws Error (bad_input) with file and line: a row that is not two numbers, times that do not ascend, no rows
void read_points(const std::filesystem::path& path, Schedule& table, std::string_view column);

/// The schedule of a time that begins later, s.
Schedule delayed(Schedule schedule, double time);

struct NamedSchedule {
  std::string name;
  Schedule schedule;
};

}  // namespace equidem
