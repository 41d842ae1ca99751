// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// [shaking]: a box that moves.
#include <cmath>
#include <span>

#include "equidem/casefile/engine/value.hpp"
#include "equidem/casefile/grains/grain_tables.hpp"

namespace equidem::casefile {
std::vector<Key<ShakingOptions>> shaking_keys() {
  using S = ShakingOptions;
  return {key("direction", &S::direction, "of any length"),
          key("acceleration", &S::acceleration, required, unit("m/s²"), positive,
              "amplitude a: the box has a cos(2 pi frequency (t - start)); from rest, without drift or a jump in "
              "velocity, it moves to and fro between where it stands and 2 a/(2 pi frequency)² further on, and "
              "after whole cycles rests where it was; walls follow other motions by a [[schedule]] of kind table"),
          key("frequency", &S::frequency, required, unit("Hz"), positive),
          key("start", &S::start, unit("s"), not_negative, "start of the shaking"),
          key("cycles", &S::cycles, from(1, 1e9), "or give duration; neither: to the end of the run or of the stage"),
          key("duration", &S::duration, unit("s"), positive, "duration of whole cycles")};
}

void bind_shaking(File<GrainTables>& file) {
  file.table("shaking", &GrainTables::shaking_table, "walls that move all alike: a box that shakes")
      .keys(shaking_keys());
}

Shaking read_shaking(const TomlValue& table, const std::string& path, const ShakingOptions& given,
                     std::optional<double> duration) {
  if (!duration && !given.cycles && !given.duration)
    fail_at(table, path, "neither cycles nor duration is given", "the length of the stage is not given in seconds",
            "Give cycles or duration");
  return at_key(table, path, [&] { return shaking_of(given, duration.value_or(INFINITY)); });
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
               [&] { shake(walls.subspan(k, 1), shaking.direction, shaking.displacement); });
  }
  if (!any)
    fail_at(table, "shaking", "there is no wall that shakes", "a box moves by its walls",
            walls.empty() ? "Add a [[wall]]" : "Leave out shaken = false where a wall belongs to the box");
  tables.shaking = shaking;
}

}  // namespace equidem::casefile
