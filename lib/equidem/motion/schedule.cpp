// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/motion/schedule.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "equidem/core/error.hpp"
#include "equidem/core/table_file.hpp"
#include "equidem/core/text.hpp"
#include "equidem/core/turns.hpp"

namespace equidem {
namespace {

double on_ramp(const Schedule& ramp, double time) {
  if (time <= ramp.start) return 0;
  if (time >= ramp.end) return ramp.value;
  // (1 - cos(pi s))/2 = sin²(pi s/2)
  const double root = sine_of_turns(0.25 * (time - ramp.start) / (ramp.end - ramp.start));
  return ramp.value * (root * root);
}

double in_table(const Schedule& table, double time) {
  const auto next = std::upper_bound(table.times.begin(), table.times.end(), time);
  if (next == table.times.begin()) return table.values.front();
  if (next == table.times.end()) return table.values.back();
  const auto k = static_cast<std::size_t>(next - table.times.begin());
  const double share = (time - table.times[k - 1]) / (table.times[k] - table.times[k - 1]);
  return table.values[k - 1] + share * (table.values[k] - table.values[k - 1]);
}

/// value (1 - cos(2 pi s)) = 2 value sin²(pi s)
double in_cycles(const Schedule& cycles, double time) {
  if (time <= cycles.start || time >= cycles.end) return 0;
  const double root = sine_of_turns(0.5 * cycles.frequency * (time - cycles.start));
  return 2 * cycles.value * (root * root);
}

void check_table(const Schedule& table) {
  if (table.times.empty() || table.times.size() != table.values.size()) {
    bad_input(fmt::format("a table has {} and {}", counted(static_cast<long long>(table.times.size()), "time"),
                          counted(static_cast<long long>(table.values.size()), "value")),
              "each time needs its value", "Give as many of one as of the other, at least one");
  }
  for (std::size_t k = 0; k < table.times.size(); ++k) {
    check_range({}, table.times[k], "time of a schedule", "s");
    check_range({}, table.values[k], "value of a schedule");
    if (k > 0 && !(table.times[k] > table.times[k - 1])) {
      bad_input(fmt::format("the time {} s comes after {} s", table.times[k], table.times[k - 1]),
                "times ascend, and a value cannot jump", "Order the points and leave out repeated times");
    }
  }
}

void check_cycles(const Schedule& schedule) {
  const double cycles = schedule.frequency * (schedule.end - schedule.start);
  if (cycles >= 0.5 && std::abs(cycles - std::round(cycles)) <= 1e-9 * cycles) return;
  bad_input(fmt::format("from {} s to {} s there are {} cycles", schedule.start, schedule.end, cycles),
            "only a whole number of them begins and ends at rest", "Put the end whole periods after the start");
}

}  // namespace

double Schedule::at(double time) const {
  switch (kind) {
    case Kind::constant:
      return value;
    case Kind::ramp:
      return on_ramp(*this, time);
    case Kind::sine:
      return time <= start ? 0 : value * sine_of_turns(frequency * (time - start));
    case Kind::table:
      return in_table(*this, time);
    case Kind::cycles:
      return in_cycles(*this, time);
  }
  return 0;
}

void check(const Schedule& schedule) {
  if (schedule.kind == Schedule::Kind::table) return check_table(schedule);
  check_range({}, schedule.value, "value of a schedule");
  if (!schedule.changes()) return;
  check_range({}, schedule.start, "start of a schedule", "s");
  const bool cycles = schedule.kind == Schedule::Kind::cycles;
  if (schedule.kind == Schedule::Kind::sine || cycles) {
    check_positive(schedule.frequency, "frequency of a schedule", "Hz");
    if (!cycles) return;
  }
  check_range({}, schedule.end, "end of a schedule", "s");
  if (cycles) return check_cycles(schedule);
  if (!(schedule.end > schedule.start)) {
    bad_input(fmt::format("the ramp ends at {} s and starts at {} s", schedule.end, schedule.start),
              "it rises from start to end", "Put the end after the start");
  }
}

MissedEvent missed_event(const Schedule& schedule, double step, double end) {
  MissedEvent most;
  const bool cycles = schedule.kind == Schedule::Kind::cycles;
  if ((schedule.kind == Schedule::Kind::sine || cycles) && schedule.value != 0 && schedule.start < end) {
    const double turns = schedule.frequency * step;  // a peak may lie in the middle of a step
    most = {turns < 0.5 ? 1 - std::cos(std::numbers::pi * turns) : 1.0,
            schedule.start + (cycles ? 0.5 : 0.25) / schedule.frequency};
  }
  if (schedule.kind != Schedule::Kind::table) return most;
  const auto [low, high] = std::minmax_element(schedule.values.begin(), schedule.values.end());
  for (std::size_t k = 0; k < schedule.times.size() && *low < *high; ++k) {
    const double time = schedule.times[k], value = schedule.values[k];
    if (time <= 0 || time >= end) continue;
    const double before = step * std::floor(time / step);
    const double a = schedule.at(before), b = schedule.at(before + step);
    const double share = std::max({0.0, value - std::max(a, b), std::min(a, b) - value}) / (*high - *low);
    if (share > most.share) most = {share, time};
  }
  return most;
}

std::int64_t count_steps(double duration, double step) {
  constexpr double most = 1e15;  // years of stepping, and every number below is exact in a double
  const double steps = std::ceil(duration / step * (1 - 1e-12));
  if (steps <= most) return std::llround(steps);
  bad_input(fmt::format("{:.3g} s in steps of {:.3g} s are {:.3g} steps", duration, step, steps),
            fmt::format("no run makes more than {:.0e}", most), "Shorten the duration, or take a longer step");
}

Schedule scaled(Schedule schedule, double factor) {
  schedule.value *= factor;
  for (double& value : schedule.values) value *= factor;
  return schedule;
}

Schedule delayed(Schedule schedule, double time) {
  schedule.start += time;
  schedule.end += time;
  for (double& at : schedule.times) at += time;
  return schedule;
}

void read_points(const std::filesystem::path& path, Schedule& table, std::string_view column) {
  const std::vector<std::string> of_time = {"time", "t"}, of_value = {std::string(column)};
  TableFile file(path, {of_time, of_value});
  const auto check_points = [&](std::size_t points) {
    if (points > 0) return;
    bad_input(fmt::format("'{}' has no points", path.string()), "a table needs at least one", "Add rows like 0.5,1.0");
  };
  check_points(file.width());
  std::size_t first = 0, second = 1;
  if (!file.names().empty()) {
    const std::string why = "a schedule has times and values";
    first = file.need(of_time, why);
    second = file.need(of_value, why);
  }
  const double seconds = file.factor(first, Dimension::time).value_or(1), unit = file.factor(second, {}).value_or(1);
  while (file.next()) {
    if (file.names().empty() && file.width() != 2)
      file.fail("this row is not a time and a value", "two numbers with a comma are needed",
                fmt::format("Write it like 0.5,1.0; the first row may be time,{}", column));
    const double time = seconds * file.number(first, "time"), value = unit * file.number(second, column);
    if (!table.times.empty() && time <= table.times.back()) {
      file.fail(fmt::format("the time {} s comes after {} s", time, table.times.back()),
                "times ascend, and a value cannot jump", "Order the rows and leave out repeated times");
    }
    table.times.push_back(time);
    table.values.push_back(value);
  }
  check_points(table.times.size());
}

}  // namespace equidem
