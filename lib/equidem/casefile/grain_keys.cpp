// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/casefile/grain_keys.hpp"

#include <string_view>

#include "equidem/casefile/bond_case.hpp"
#include "equidem/casefile/case_tables.hpp"
#include "equidem/casefile/engine/read_value.hpp"
#include "equidem/casefile/grain_pair_keys.hpp"
#include "equidem/casefile/measure_case.hpp"
#include "equidem/casefile/shaking_case.hpp"

namespace equidem {
using namespace casefile;
namespace {

using enum KeyType;

constexpr const char* none = KeySpec::none;

std::vector<KeySpec> keys_of_bodies() {
  return {
      {.table = "grains",
       .name = "body",
       .type = choice,
       .fallback = "\"disc\"",
       .choices = {"disc", "sphere"},
       .help = "disc: a cylinder, kg and N per metre of depth; sphere: kg and N"},
      {.table = "grains",
       .name = "density",
       .type = number,
       .unit = "kg/m³",
       .fallback = none,
       .range = Range::positive(),
       .help = "of every grain that has none of its own"},
      {.table = "grains",
       .name = "path",
       .type = path,
       .fallback = none,
       .help =
           "a CSV file of grains: the columns x, y, radius and, where wanted, short_half_axis (of an ellipse, radius "
           "being the long one), discs (of a clump: x y r; x y r), vx, vy, spin, angle, density, group; grains.csv "
           "of run and pack can be read back"},

      {.table = "grain", .name = "position", .type = vector, .unit = "m", .help = "of the mass centre"},
      {.table = "grain",
       .name = "radius",
       .type = number,
       .unit = "m",
       .fallback = none,
       .range = Range::positive(),
       .help = "of a disc or sphere; or give one of the next two"},
      {.table = "grain",
       .name = "half_axes",
       .type = vector,
       .unit = "m",
       .fallback = none,
       .range = Range::positive(),
       .help = "[a, b] of an ellipse, the long one first: it lies along x at angle 0"},
      {.table = "grain",
       .name = "discs",
       .type = circles,
       .unit = "m",
       .fallback = none,
       .help = "of a clump, tied rigidly, in the frame of the body at angle 0; they may overlap, what two share counts "
               "once; all are shifted so that their mass centre is the origin"},
      {.table = "grain", .name = "velocity", .type = vector, .unit = "m/s", .fallback = "[0.0, 0.0]"},
      {.table = "grain",
       .name = "spin",
       .type = number,
       .unit = "rad/s",
       .fallback = "0.0",
       .help = "counter-clockwise"},
      {.table = "grain", .name = "angle", .type = number, .unit = "rad", .fallback = "0.0"},
      {.table = "grain",
       .name = "density",
       .type = number,
       .unit = "kg/m³",
       .fallback = none,
       .range = Range::positive(),
       .help = "instead of that of [grains]"},
      {.table = "grain",
       .name = "group",
       .type = text,
       .fallback = "\"grains\"",
       .help = "for [[collisions.pair]] and [[probe]]"},
  };
}

std::vector<KeySpec> keys_of_walls() {
  const std::vector<std::string> arc = {"arc"};
  return {
      {.table = "wall", .name = "name", .type = text, .help = "for reports, and for [[collisions.pair]]"},
      {.table = "wall",
       .name = "shape",
       .type = choice,
       .fallback = "\"line\"",
       .choices = {"line", "segment", "arc"},
       .help = "line: endless, grains on one side; segment, arc: thin, with two sides and two ends"},
      {.table = "wall",
       .name = "point",
       .type = vector,
       .unit = "m",
       .when_key = "shape",
       .when = {"line", "segment"},
       .help = "on the line; the first end of the segment"},
      {.table = "wall",
       .name = "normal",
       .type = vector,
       .when_key = "shape",
       .when = {"line"},
       .help = "towards the grains, of any length"},
      {.table = "wall", .name = "end", .type = vector, .unit = "m", .when_key = "shape", .when = {"segment"}},
      {.table = "wall", .name = "centre", .type = vector, .unit = "m", .when_key = "shape", .when = arc},
      {.table = "wall",
       .name = "radius",
       .type = number,
       .unit = "m",
       .range = Range::positive(),
       .when_key = "shape",
       .when = arc},
      {.table = "wall",
       .name = "from",
       .type = number,
       .unit = "rad",
       .fallback = "0.0",
       .when_key = "shape",
       .when = arc,
       .help = "counter-clockwise from here ..."},
      {.table = "wall",
       .name = "to",
       .type = number,
       .unit = "rad",
       .fallback = "6.283185307179586",
       .when_key = "shape",
       .when = arc,
       .help = "... to here"},
      {.table = "wall",
       .name = "displacement",
       .type = number,
       .unit = "m",
       .fallback = none,
       .help = "along direction, times the schedule"},
      {.table = "wall",
       .name = "direction",
       .type = vector,
       .fallback = none,
       .help = "of any length; left out: the normal of a line"},
      {.table = "wall", .name = "schedule", .type = text, .fallback = none, .help = "of the displacement"},
  };
}

std::vector<KeySpec> keys_of_motion() {
  return {
      {.table = "run", .name = "duration", .type = number, .unit = "s", .range = Range::positive()},
      {.table = "run",
       .name = "time_step",
       .type = number_or_auto,
       .unit = "s",
       .fallback = "\"auto\"",
       .range = Range::positive(),
       .help = "auto: the shortest contact over steps_per_contact"},
      {.table = "run",
       .name = "steps_per_contact",
       .type = number,
       .fallback = none,
       .range = {.low = 2},
       .help = "of an automatic step; left out: 50 for laws that give a force, 10 for the maps, pi (that is omega dt = "
               "1) for exact_flow"},
      {.table = "run",
       .name = "scheme",
       .type = choice,
       .fallback = none,
       .choices = {"semi_implicit_euler", "velocity_verlet", "corrected_verlet"},
       .help = "of laws that give a force; semi_implicit_euler (default): first order, contacts that stick "
               "do not creep; velocity_verlet: second order, as LAMMPS steps; corrected_verlet: the same motion, but "
               "contacts that begin or end within a step push for their part of it only: for impacts, and where the "
               "balance of energy counts"},
      {.table = "run",
       .name = "gravity",
       .type = vector,
       .unit = "m/s²",
       .fallback = "[0.0, 0.0]",
       .help = "such as [0.0, -9.81]"},

      {.table = "probe", .name = "name", .type = text, .help = "begins the names of its columns"},
      {.table = "probe", .name = "group", .type = text, .fallback = none, .help = "of grains; or give grains"},
      {.table = "probe",
       .name = "grains",
       .type = discs,
       .fallback = none,
       .help = "counted from 0; those of the file first"},
      {.table = "probe",
       .name = "quantities",
       .type = words,
       .fallback = "[\"position\"]",
       .choices = {"position", "velocity", "angle", "spin"},
       .help = "the means over these grains"},
  };
}

/// Keys that mean the same in every case file.
bool is_shared(const KeySpec& key) {
  const std::string_view table = key.table, name = key.name;
  if (table.empty()) return name != "springs";
  return table == "schedule" || (table == "output" && name != "vtk");
}

}  // namespace

const FileSpec& grain_file_spec() {
  static const FileSpec spec = [] {
    FileSpec file{.schema = casefile::case_file().spec().schema,
                  .noun = "case file of colliding bodies",
                  .tables = {{.name = "grains", .completed = true, .help = "what all grains have in common"},
                             {.name = "grain", .repeated = true, .help = "one body"},
                             {.name = "bonds", .help = "what all bonds have in common"},
                             {.name = "bond", .repeated = true, .help = "two discs tied by dashpots"},
                             {.name = "collisions", .required = true, .help = "how bodies meet, rebound and part"},
                             {.name = "collisions.walls", .help = "where a grain and a wall differ from that"},
                             {.name = "collisions.pair",
                              .repeated = true,
                              .help = "where two groups, or a group and a wall, differ from that"},
                             {.name = "wall", .repeated = true, .help = "a wall of infinite mass"},
                             {.name = "run", .required = true, .help = "how long and in which steps"},
                             {.name = "schedule", .repeated = true, .help = "how a wall moves"},
                             {.name = "shaking", .help = "walls that move all alike: a box that shakes"},
                             {.name = "measures", .help = "what is read off the bodies in a box"},
                             {.name = "probe", .repeated = true, .help = "a history of grains"},
                             {.name = "output", .completed = true, .help = "what is written with --out"}},
                  .keys = {}};
    for (const KeySpec& key : casefile::case_file().spec().keys)
      if (is_shared(key)) file.keys.push_back(key);
    for (const auto& more : {keys_of_bodies(), bond_keys(), keys_of_collisions(), keys_of_walls(), keys_of_motion(),
                             shaking_keys(), measure_keys()})
      file.keys.insert(file.keys.end(), more.begin(), more.end());
    return file;
  }();
  return spec;
}

bool describes_grains(const TomlValue& root) {
  for (const char* table : {"grains", "grain", "collisions"}) {
    const TomlValue* found = root.find(table);
    if (found == nullptr) continue;
    if (root.find("assembly") == nullptr) return true;
    fail_at(*found, table, "grains that collide and [assembly] are both in the case",
            "contacts of an assembly are there from the start and stay", "Keep one of them");
  }
  return false;
}

}  // namespace equidem
