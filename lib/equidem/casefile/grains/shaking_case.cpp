// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// [shaking]: a box that moves.
#include <span>
#include <utility>

#include "equidem/casefile/engine/read_value.hpp"
#include "equidem/casefile/grains/grain_tables.hpp"

namespace equidem {
namespace {

using casefile::fail_at;
using casefile::ShakingTable;

double unit_of(const ShakingTable& given) {
  switch (given.unit) {
    case ShakingTable::Unit::m_per_s2:
      break;
    case ShakingTable::Unit::gal:
      return gal;
    case ShakingTable::Unit::g:
      return standard_gravity;
  }
  return 1;
}

/// A key that has no meaning beside the others.
void refuse_beside(const TomlValue& table, const char* key, const std::string& why) {
  if (const TomlValue* value = table.find(key))
    fail_at(*value, fmt::format("shaking.{}", key), fmt::format("{} does not apply", key), why, "Remove it");
}

HarmonicShaking harmonic(const TomlValue& table, const ShakingTable& given) {
  for (const char* key : {"quantity", "baseline", "scale"})
    refuse_beside(table, key, "it is for a record, and the box shakes with a frequency");
  for (const char* key : {"acceleration", "frequency"})
    if (table.find(key) == nullptr)
      fail_at(table, "shaking", fmt::format("it is not said how the box moves: {} is missing", key),
              "acceleration and frequency say it, or a record",
              "Give acceleration and frequency, or record = \"FILE\"");
  HarmonicShaking options = given.harmonic;
  options.acceleration *= unit_of(given);
  options.start = given.start;
  return options;
}

RecordedShaking recorded(const TomlValue& table, const ShakingTable& given) {
  for (const char* key : {"acceleration", "frequency", "cycles", "duration"})
    refuse_beside(table, key, "the record says how the box moves");
  RecordedShaking options = given.recorded;
  const bool displacement = options.quantity == RecordedShaking::Quantity::displacement;
  if (displacement) refuse_beside(table, "baseline", "a recorded displacement is followed as it is");
  if (!displacement) options.scale *= unit_of(given);
  options.start = given.start;
  try {
    Schedule points{.kind = Schedule::Kind::table};
    read_points(*given.record, points, displacement ? "displacement" : "acceleration");
    options.times = std::move(points.times);
    options.values = std::move(points.values);
  } catch (const Error& error) {
    throw error.at(fmt::format("{}: shaking.record", table.find("record")->where()));
  }
  return options;
}

}  // namespace

void casefile::bind_shaking(File<GrainTables>& file) {
  using S = ShakingTable;
  file.table("shaking", &GrainTables::shaking_table, "walls that move all alike: a box that shakes")
      .keys({key("direction", &S::direction, "of any length"),
             key("acceleration", &S::harmonic, &HarmonicShaking::acceleration, optional, unit("that of unit"), positive,
                 "amplitude a: the box has a cos(2 pi frequency (t - start)); from rest, without drift or a jump in "
                 "velocity, it moves to and fro between where it stands and 2 a/(2 pi frequency)² further on, and "
                 "after whole cycles rests where it was"),
             key("unit", &S::unit, "of accelerations; gal: 0.01 m/s², g: 9.80665 m/s²"),
             key("frequency", &S::harmonic, &HarmonicShaking::frequency, optional, unit("Hz"), positive),
             key("start", &S::start, unit("s"), not_negative,
                 "start of the shaking; the first moment of a record is put there"),
             key("cycles", &S::harmonic, &HarmonicShaking::cycles, from(1, 1e9),
                 "or give duration; neither: to the end of the run"),
             key("duration", &S::harmonic, &HarmonicShaking::duration, unit("s"), positive, "duration of whole cycles"),
             key("record", &S::record,
                 "a recorded motion instead: a CSV file with rows time,acceleration in s and unit, linear between them "
                 "and integrated twice exactly from rest"),
             key("quantity", &S::recorded, &RecordedShaking::quantity, optional,
                 "quantity of the record; displacement: m, followed by a cubic spline that is at rest at both ends"),
             key("baseline", &S::recorded, &RecordedShaking::baseline, optional,
                 "correction of a recorded acceleration; rest (default): a straight line in time, and the box ends at "
                 "rest where it began; velocity: a constant, and it ends at rest somewhere else"),
             key("scale", &S::recorded, &RecordedShaking::scale, optional, not_zero, "factor of the record")});
}

Shaking casefile::read_shaking(const TomlValue& root, GrainTables& tables) {
  const TomlValue& table = *root.find("shaking");
  const ShakingTable& given = *tables.shaking_table;
  ShakingOptions options{.direction = given.direction};
  if (given.record) {
    options.motion = recorded(table, given);
  } else {
    options.motion = harmonic(table, given);
  }
  Shaking shaking;
  at_key(table, "shaking", [&] { shaking = shaking_of(options, tables.duration); });
  bool any = false;
  const std::span<Wall> walls = tables.scene.walls;
  for (std::size_t k = 0; k < walls.size(); ++k) {
    if (!tables.wall_tables[k].shaken) continue;
    any = true;
    try {
      shake(walls.subspan(k, 1), shaking.direction, shaking.motion.displacement);
    } catch (const Error& error) {
      throw error.at(fmt::format("{}: wall", repeated(root, "wall")[k].where()));
    }
  }
  if (!any)
    fail_at(table, "shaking", "there is no wall that shakes", "a box moves by its walls",
            walls.empty() ? "Add a [[wall]]" : "Leave out shaken = false where a wall belongs to the box");
  return shaking;
}

}  // namespace equidem
