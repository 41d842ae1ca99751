// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// [shaking]: a box that moves.
#include <cmath>
#include <span>
#include <utility>

#include "equidem/casefile/engine/read_value.hpp"
#include "equidem/casefile/grains/grain_tables.hpp"

namespace equidem::casefile {
namespace {

HarmonicShaking harmonic(const ShakingTable& given) {
  HarmonicShaking options = given.harmonic;
  options.acceleration *= entry_of(given.unit).size;
  options.start = given.start;
  return options;
}

RecordedShaking recorded(const TomlValue& table, const std::string& path, const ShakingTable& given) {
  RecordedShaking options = given.recorded;
  const bool displacement = options.quantity == RecordedShaking::Quantity::displacement;
  if (const TomlValue* baseline = table.find("baseline"); displacement && baseline != nullptr)
    fail_at(*baseline, path + ".baseline", "baseline does not apply", "a recorded displacement is followed as it is",
            "Remove it");
  if (!displacement) options.scale *= entry_of(given.unit).size;
  options.start = given.start;
  Schedule points{.kind = Schedule::Kind::table};
  with_key(table, path, "record",
           [&] { read_points(*given.record, points, displacement ? "displacement" : "acceleration"); });
  options.times = std::move(points.times);
  options.values = std::move(points.values);
  return options;
}

}  // namespace

std::vector<Key<ShakingTable>> shaking_keys() {
  using S = ShakingTable;
  const std::string followed = "the record says how the box moves";
  const auto of_record = only_with({"record"}, "it is for a record");
  return {key("direction", &S::direction, "of any length"),
          key("acceleration", &S::harmonic, &HarmonicShaking::acceleration, unit("that of unit"), positive,
              or_instead({"record"}, "the box follows acceleration and frequency, or a record"),
              only_with({"frequency"}, "acceleration and frequency say how the box moves"),
              "amplitude a: the box has a cos(2 pi frequency (t - start)); from rest, without drift or a jump in "
              "velocity, it moves to and fro between where it stands and 2 a/(2 pi frequency)² further on, and "
              "after whole cycles rests where it was"),
          key("unit", &S::unit, "of accelerations; gal: 0.01 m/s², g: 9.80665 m/s²"),
          key("frequency", &S::harmonic, &HarmonicShaking::frequency, optional, unit("Hz"), positive,
              only_with({"acceleration"}, "acceleration and frequency say how the box moves")),
          key("start", &S::start, unit("s"), not_negative,
              "start of the shaking; the first moment of a record is put there"),
          key("cycles", &S::harmonic, &HarmonicShaking::cycles, from(1, 1e9), not_beside({"record"}, followed),
              "or give duration; neither: to the end of the run or of the stage"),
          key("duration", &S::harmonic, &HarmonicShaking::duration, unit("s"), positive,
              not_beside({"record"}, followed), "duration of whole cycles"),
          key("record", &S::record,
              "a recorded motion instead: a CSV file with rows time,acceleration in s and unit, linear between them "
              "and integrated twice exactly from rest"),
          key("quantity", &S::recorded, &RecordedShaking::quantity, optional, of_record,
              "quantity of the record; displacement: m, followed by a cubic spline that is at rest at both ends"),
          key("baseline", &S::recorded, &RecordedShaking::baseline, optional, of_record,
              "correction of a recorded acceleration; rest (default): a straight line in time, and the box ends at "
              "rest where it began; velocity: a constant, and it ends at rest somewhere else"),
          key("scale", &S::recorded, &RecordedShaking::scale, optional, of_record, not_zero, "factor of the record")};
}

void bind_shaking(File<GrainTables>& file) {
  file.table("shaking", &GrainTables::shaking_table, "walls that move all alike: a box that shakes")
      .keys(shaking_keys());
}

Shaking read_shaking(const TomlValue& table, const std::string& path, const ShakingTable& given,
                     std::optional<double> duration) {
  if (!duration && !given.record && !given.harmonic.cycles && !given.harmonic.duration)
    fail_at(table, path, "neither cycles nor duration is given", "the length of the stage is not given in seconds",
            "Give cycles or duration");
  ShakingOptions options{.direction = given.direction, .motion = harmonic(given)};
  if (given.record) options.motion = recorded(table, path, given);
  return at_key(table, path, [&] { return shaking_of(options, duration.value_or(INFINITY)); });
}

void complete_shaking(const TomlValue& root, GrainTables& tables) {
  const TomlValue& table = *root.find("shaking");
  const Shaking shaking = read_shaking(table, "shaking", *tables.shaking_table, tables.duration);
  bool any = false;
  const std::span<Wall> walls = tables.scene.walls;
  for (std::size_t k = 0; k < walls.size(); ++k) {
    if (!tables.wall_tables[k].shaken) continue;
    any = true;
    with_place(fmt::format("{}: wall", repeated(root, "wall")[k].where()),
               [&] { shake(walls.subspan(k, 1), shaking.direction, shaking.motion.displacement); });
  }
  if (!any)
    fail_at(table, "shaking", "there is no wall that shakes", "a box moves by its walls",
            walls.empty() ? "Add a [[wall]]" : "Leave out shaken = false where a wall belongs to the box");
  tables.shaking = shaking;
}

}  // namespace equidem::casefile
