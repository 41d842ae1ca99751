// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/casefile/shaking_case.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "equidem/casefile/read_value.hpp"
#include "equidem/casefile/schedule_case.hpp"

namespace equidem {
namespace {

namespace fs = std::filesystem;

double unit_of(const TomlValue& table) {
  const std::string& unit = text(table, "unit");
  return unit == "gal" ? gal : unit == "g" ? standard_gravity : 1;
}

/// A key that has no meaning beside the others.
void refuse_beside(const TomlValue& table, const char* key, const std::string& why) {
  if (const TomlValue* value = table.find(key))
    fail_at(*value, fmt::format("shaking.{}", key), fmt::format("{} does not apply", key), why, "Remove it");
}

std::int64_t count_cycles(const TomlValue& table, double frequency, double start, double run_duration) {
  const TomlValue* cycles = table.find("cycles");
  const TomlValue* duration = table.find("duration");
  if (cycles != nullptr) {
    refuse_beside(table, "duration", "cycles says how long the box shakes");
    return cycles->integer;
  }
  const double periods = frequency * (duration != nullptr ? duration->real : run_duration - start);
  const double whole = std::round(periods);
  if (duration != nullptr && (whole < 1 || std::abs(periods - whole) > 1e-6 * whole))
    fail_at(*duration, "shaking.duration",
            fmt::format("{} s are {:.6g} cycles of {} Hz", duration->real, periods, frequency),
            "only whole cycles end at rest",
            fmt::format("Make it {:.6g} s, or give cycles", std::max(1.0, whole) / frequency));
  constexpr double most = 1e12;
  if (!(periods < most))
    fail_at(*table.find("frequency"), "shaking.frequency", fmt::format("the box would shake {:.3g} times", periods),
            "the run has fewer steps than that", "Lower it, or give cycles");
  // On beyond the end of the run, which may cut a cycle short.
  return static_cast<std::int64_t>(duration != nullptr ? whole : std::max(1.0, std::ceil(periods - 1e-9 * whole)));
}

void read_harmonic(const TomlValue& table, double run_duration, ShakingCase& shaking) {
  for (const char* key : {"quantity", "baseline", "scale"})
    refuse_beside(table, key, "it is for a record, and the box shakes with a frequency");
  const TomlValue* acceleration = table.find("acceleration");
  const TomlValue* frequency = table.find("frequency");
  if (acceleration == nullptr || frequency == nullptr) {
    const char* missing = acceleration == nullptr ? "acceleration" : "frequency";
    fail_at(table, "shaking", fmt::format("it is not said how the box moves: {} is missing", missing),
            "acceleration and frequency say it, or a record", "Give acceleration and frequency, or record = \"FILE\"");
  }
  const double a = unit_of(table) * acceleration->real, start = number(table, "start");
  if (!(start < run_duration))
    fail_at(*table.find("start"), "shaking.start", fmt::format("the box begins to shake at {} s", start),
            fmt::format("the run ends at {} s", run_duration), "Start earlier, or run longer");
  shaking.frequency = frequency->real;
  shaking.cycles = count_cycles(table, shaking.frequency, start, run_duration);
  try {
    shaking.motion.displacement = harmonic_shaking(a, shaking.frequency, start, shaking.cycles);
  } catch (const Error& error) {
    throw error.at(fmt::format("{}: shaking.frequency", frequency->where()));
  }
  const double omega = 2 * std::numbers::pi * shaking.frequency;
  shaking.motion.peak_acceleration = a;
  shaking.motion.peak_velocity = a / omega;
  shaking.motion.peak_displacement = 2 * a / (omega * omega);
}

void read_record(TomlValue& table, const fs::path& folder, ShakingCase& shaking) {
  for (const char* key : {"acceleration", "frequency", "cycles", "duration"})
    refuse_beside(table, key, "the record says how the box moves");
  shaking.recorded = true;
  TomlValue& path = *table.find("record");
  const fs::path file = opened(path.text, folder);
  const TomlValue* quantity = table.find("quantity");
  const bool displacement = quantity != nullptr && quantity->text == "displacement";
  if (displacement) refuse_beside(table, "baseline", "a recorded displacement is followed as it is");
  const double factor = optional_number(table, "scale").value_or(1) * (displacement ? 1 : unit_of(table));
  const double start = number(table, "start");
  try {
    Schedule points{.kind = Schedule::Kind::table};
    read_points(file, points, displacement ? "displacement" : "acceleration");
    points = scaled(points, factor);
    const TomlValue* baseline = table.find("baseline");
    shaking.motion = displacement
                         ? follow_motion(points.times, points.values, start)
                         : integrate_motion(points.times, points.values, start,
                                            baseline != nullptr && baseline->text == "velocity" ? Baseline::velocity
                                                                                                : Baseline::rest);
  } catch (const Error& error) {
    throw error.at(fmt::format("{}: shaking.record", path.where()));
  }
  path.text = file.string();
}

}  // namespace

std::vector<KeySpec> shaking_keys() {
  using enum KeyType;
  constexpr const char* none = KeySpec::none;
  return {
      {.table = "shaking", .name = "direction", .type = vector, .fallback = "[1.0, 0.0]", .help = "of any length"},
      {.table = "shaking",
       .name = "acceleration",
       .type = number,
       .unit = "that of unit",
       .fallback = none,
       .range = Range::positive(),
       .help = "amplitude a: the box has a cos(2 pi frequency (t - start)); from rest, without drift or a jump in "
               "velocity, it moves to and "
               "fro between where it stands and 2 a/(2 pi frequency)² further on, and after whole cycles rests where "
               "it was"},
      {.table = "shaking",
       .name = "unit",
       .type = choice,
       .fallback = "\"m/s2\"",
       .choices = {"m/s2", "gal", "g"},
       .help = "of accelerations; gal: 0.01 m/s², g: 9.80665 m/s²"},
      {.table = "shaking",
       .name = "frequency",
       .type = number,
       .unit = "Hz",
       .fallback = none,
       .range = Range::positive()},
      {.table = "shaking",
       .name = "start",
       .type = number,
       .unit = "s",
       .fallback = "0.0",
       .range = Range::not_negative(),
       .help = "of the shaking; the first moment of a record is put there"},
      {.table = "shaking",
       .name = "cycles",
       .type = whole,
       .fallback = none,
       .range = Range::from(1, 1e9),
       .help = "or give duration; neither: to the end of the run"},
      {.table = "shaking",
       .name = "duration",
       .type = number,
       .unit = "s",
       .fallback = none,
       .range = Range::positive(),
       .help = "of whole cycles"},
      {.table = "shaking",
       .name = "record",
       .type = path,
       .fallback = none,
       .help = "a recorded motion instead: a CSV file with rows time,acceleration in s and unit, linear between them "
               "and integrated twice "
               "exactly from rest"},
      {.table = "shaking",
       .name = "quantity",
       .type = choice,
       .fallback = none,
       .choices = {"acceleration", "displacement"},
       .help = "what the record holds; displacement: m, followed by a cubic spline that is at rest at both ends"},
      {.table = "shaking",
       .name = "baseline",
       .type = choice,
       .fallback = none,
       .choices = {"rest", "velocity"},
       .help = "what is taken from a recorded acceleration; rest (default): a straight line in time, and the box ends "
               "at rest "
               "where it began; velocity: a constant, and it ends at rest somewhere else"},
      {.table = "shaking",
       .name = "scale",
       .type = number,
       .fallback = none,
       .range = {.zero_excluded = true},
       .help = "factor of the record"},
      {.table = "wall", .name = "shaken", .type = flag, .fallback = none, .help = "false: [shaking] does not move it"},
  };
}

ShakingCase read_shaking(TomlValue& root, const fs::path& folder, double run_duration, std::span<GrainWall> walls) {
  TomlValue& table = *root.find("shaking");
  ShakingCase shaking;
  const Vec2 direction = vector(table, "direction");
  const double length = norm(direction);
  if (!(length > 0))
    fail_at(*table.find("direction"), "shaking.direction", "the direction of the shaking is zero",
            "it says where the box moves", "Give a direction, such as [1.0, 0.0]");
  shaking.direction = direction / length;
  if (table.find("record") != nullptr) {
    read_record(table, folder, shaking);
  } else {
    read_harmonic(table, run_duration, shaking);
  }
  constexpr double fastest = 3e8;  // light
  if (!(shaking.motion.peak_velocity < fastest))
    fail_at(table, "shaking", fmt::format("the box would move with {:.3g} m/s", shaking.motion.peak_velocity),
            fmt::format("nothing is faster than {:.0e} m/s", fastest),
            "Give a smaller acceleration, or check the units");
  bool any = false;
  const auto& tables = repeated(root, "wall");
  for (std::size_t k = 0; k < walls.size(); ++k) {
    const TomlValue* shaken = tables[k].find("shaken");
    if (shaken != nullptr && !shaken->boolean) continue;
    any = true;
    try {
      shake(walls.subspan(k, 1), shaking.direction, shaking.motion.displacement);
    } catch (const Error& error) {
      throw error.at(fmt::format("{}: wall", tables[k].where()));
    }
  }
  if (!any)
    fail_at(table, "shaking", "there is no wall that shakes", "a box moves by its walls",
            walls.empty() ? "Add a [[wall]]" : "Leave out shaken = false where a wall belongs to the box");
  return shaking;
}

}  // namespace equidem
