// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/casefile/shaking_case.hpp"

#include <utility>

#include "equidem/casefile/engine/read_value.hpp"
#include "equidem/casefile/schedule_case.hpp"

namespace equidem {
using namespace casefile;
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

HarmonicShaking read_harmonic(const TomlValue& table) {
  for (const char* key : {"quantity", "baseline", "scale"})
    refuse_beside(table, key, "it is for a record, and the box shakes with a frequency");
  for (const char* key : {"acceleration", "frequency"})
    if (table.find(key) == nullptr)
      fail_at(table, "shaking", fmt::format("it is not said how the box moves: {} is missing", key),
              "acceleration and frequency say it, or a record",
              "Give acceleration and frequency, or record = \"FILE\"");
  HarmonicShaking options{.acceleration = unit_of(table) * number(table, "acceleration"),
                          .frequency = number(table, "frequency"),
                          .start = number(table, "start"),
                          .duration = optional_number(table, "duration")};
  if (const TomlValue* cycles = table.find("cycles")) options.cycles = cycles->integer;
  return options;
}

RecordedShaking read_record(TomlValue& table, const fs::path& folder) {
  for (const char* key : {"acceleration", "frequency", "cycles", "duration"})
    refuse_beside(table, key, "the record says how the box moves");
  RecordedShaking options;
  const TomlValue* quantity = table.find("quantity");
  const bool displacement = quantity != nullptr && quantity->text == "displacement";
  if (displacement) {
    options.quantity = RecordedShaking::Quantity::displacement;
    refuse_beside(table, "baseline", "a recorded displacement is followed as it is");
  }
  options.scale = optional_number(table, "scale").value_or(options.scale) * (displacement ? 1 : unit_of(table));
  options.start = number(table, "start");
  if (const TomlValue* baseline = table.find("baseline"))
    options.baseline = baseline->text == "velocity" ? Baseline::velocity : Baseline::rest;
  TomlValue& path = *table.find("record");
  const fs::path file = opened(path.text, folder);
  try {
    Schedule points{.kind = Schedule::Kind::table};
    read_points(file, points, displacement ? "displacement" : "acceleration");
    options.times = std::move(points.times);
    options.values = std::move(points.values);
  } catch (const Error& error) {
    throw error.at(fmt::format("{}: shaking.record", path.where()));
  }
  path.text = file.string();
  path.is_path = true;
  return options;
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

Shaking read_shaking(TomlValue& root, const fs::path& folder, double run_duration, std::span<Wall> walls) {
  TomlValue& table = *root.find("shaking");
  ShakingOptions options{.direction = vector(table, "direction")};
  if (table.find("record") != nullptr) {
    options.motion = read_record(table, folder);
  } else {
    options.motion = read_harmonic(table);
  }
  Shaking shaking;
  try {
    shaking = shaking_of(options, run_duration);
  } catch (const Error& error) {
    const TomlValue* value = table.find(error.where());
    fail_at(value != nullptr ? *value : table, value != nullptr ? "shaking." + error.where() : "shaking",
            error.problem(), error.why(), error.remedy());
  }
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
