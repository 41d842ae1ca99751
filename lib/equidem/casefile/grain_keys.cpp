// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/casefile/grain_keys.hpp"

#include <string_view>

#include "equidem/casefile/read_value.hpp"

namespace equidem {
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
       .help = "a CSV file of grains: the columns x, y, radius and, where wanted, vx, vy, spin, angle, density, group; "
               "grains.csv of a run can be read back"},

      {.table = "grain", .name = "position", .type = vector, .unit = "m", .help = "of the centre"},
      {.table = "grain", .name = "radius", .type = number, .unit = "m", .range = Range::positive()},
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

/// What may be said of the contacts of every pair of bodies.
/// \param base the table says it for all: then restitution is needed, friction has a default, and keys are explained
std::vector<KeySpec> keys_of_contacts(const char* table, bool base) {
  const auto fallback = [&](const char* value) { return base ? value : none; };
  std::vector<KeySpec> keys{
      {.table = table,
       .name = "restitution",
       .type = number,
       .fallback = base ? KeySpec::required : none,
       .range = Range::from(0, 1),
       .help = "speed after over speed before, of two bodies that meet head-on without gravity"},
      {.table = table,
       .name = "contact_end",
       .type = choice,
       .fallback = none,
       .choices = {"zero_force", "zero_overlap"},
       .help = "of laws with a dashpot; zero_force: contacts never pull (default, but of hertz_dashpot); zero_overlap: "
               "they may pull while the bodies part"},
      {.table = table,
       .name = "stiffness",
       .type = number,
       .unit = "N/m (hertz_dashpot N/m^1.5; discs: per m of depth)",
       .fallback = none,
       .range = Range::positive(),
       .help = "k; give it or one of the next keys"},
      {.table = table,
       .name = "dimensionless_stiffness",
       .type = number,
       .fallback = none,
       .range = Range::positive(),
       .help = "a = k dt²/m, m the reduced mass: held whatever the step and the masses; hertz_dashpot: k d^0.5 dt²/m"},
      {.table = table,
       .name = "contact_duration",
       .type = number,
       .unit = "s",
       .fallback = none,
       .range = Range::positive(),
       .help = "until the overlap is zero again, the same for all masses; not hertz_dashpot"},
      {.table = table,
       .name = "largest_overlap",
       .type = number,
       .unit = "m",
       .fallback = none,
       .range = Range::positive(),
       .help = "not exceeded by two bodies that meet at closing_speed"},
      {.table = table,
       .name = "closing_speed",
       .type = number,
       .unit = "m/s",
       .fallback = none,
       .range = Range::positive(),
       .help = "of the fastest impact expected; for largest_overlap, and for an automatic step of hertz_dashpot"},
      {.table = table,
       .name = "friction",
       .type = number,
       .fallback = fallback("0.0"),
       .range = Range::not_negative(),
       .help = "Coulomb's mu"},
      {.table = table,
       .name = "tangential_ratio",
       .type = number,
       .fallback = none,
       .range = {.low = 0, .high = 1e6},
       .help =
           "kT/kN of the tangential spring, with friction; left out: 2/7, and for the maps, which act in one or two "
           "steps, 0: no spring, contacts slide"},
      {.table = table,
       .name = "tangential_damping",
       .type = number,
       .fallback = fallback("0.0"),
       .range = Range::not_negative(),
       .help = "zeta of the tangential dashpot"},
      {.table = table,
       .name = "friction_cap",
       .type = choice,
       .fallback = fallback("\"whole_force\""),
       .choices = {"whole_force", "spring_alone"},
       .help = "what mu times the normal force limits: spring and dashpot together, or the spring alone"},
  };
  if (!base)
    for (KeySpec& key : keys) key.help = "";  // as in the base
  return keys;
}

std::vector<KeySpec> keys_of_collisions() {
  const std::vector<std::string> hertz = {"hertz_dashpot"};
  std::vector<KeySpec> keys{
      {.table = "collisions",
       .name = "law",
       .type = choice,
       .fallback = "\"exact_flow\"",
       .choices = {"exact_flow", "linear_dashpot", "hertz_dashpot", "five_case_map", "energy_map"},
       .help =
           "exact_flow: linear spring and dashpot solved exactly within the step, all contacts together; "
           "linear_dashpot (C of Fujioka & Ushijima 2005): the same by the scheme of [run]; hertz_dashpot (T): Hertz "
           "spring; five_case_map (F), energy_map (P): restitution at the first step of a contact, energy kept "
           "after it"},
      {.table = "collisions",
       .name = "young_modulus",
       .type = number,
       .unit = "Pa",
       .fallback = none,
       .range = Range::positive(),
       .when_key = "law",
       .when = hertz,
       .help = "of all spheres, walls being rigid: k by Hertz; with poisson_ratio, instead of stiffness"},
      {.table = "collisions",
       .name = "poisson_ratio",
       .type = number,
       .fallback = none,
       .range = {.low = -1, .high = 0.5, .low_open = true},
       .when_key = "law",
       .when = hertz,
       .help = "of all spheres"},
      {.table = "collisions",
       .name = "reference_length",
       .type = number,
       .unit = "m",
       .fallback = none,
       .range = Range::positive(),
       .when_key = "law",
       .when = hertz,
       .help = "d of dimensionless_stiffness; left out: twice the largest radius"},
  };
  const auto append = [&](std::vector<KeySpec> more) { keys.insert(keys.end(), more.begin(), more.end()); };
  append(keys_of_contacts("collisions", true));
  append(keys_of_contacts("collisions.walls", false));
  append({{.table = "collisions.pair", .name = "group", .type = text, .help = "of grains"},
          {.table = "collisions.pair",
           .name = "with",
           .type = text,
           .help = "a group of grains, or the name of a [[wall]]"}});
  append(keys_of_contacts("collisions.pair", false));
  return keys;
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
       .help = "of an automatic step; left out: 50 for linear_dashpot and hertz_dashpot, 10 for the maps, pi (that is "
               "omega dt = 1) for "
               "exact_flow"},
      {.table = "run",
       .name = "scheme",
       .type = choice,
       .fallback = none,
       .choices = {"semi_implicit_euler", "velocity_verlet"},
       .help = "of linear_dashpot and hertz_dashpot; semi_implicit_euler (default): gravity after the contact force; "
               "velocity_verlet: dashpots with the velocities of the half step"},
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
    FileSpec file{.schema = case_file_spec().schema,
                  .noun = "case file of colliding bodies",
                  .tables = {{.name = "grains", .completed = true, .help = "what all grains have in common"},
                             {.name = "grain", .repeated = true, .help = "one body"},
                             {.name = "collisions", .required = true, .help = "how bodies meet, rebound and part"},
                             {.name = "collisions.walls", .help = "where a grain and a wall differ from that"},
                             {.name = "collisions.pair",
                              .repeated = true,
                              .help = "where two groups, or a group and a wall, differ from that"},
                             {.name = "wall", .repeated = true, .help = "a wall of infinite mass"},
                             {.name = "run", .required = true, .help = "how long and in which steps"},
                             {.name = "schedule", .repeated = true, .help = "how a wall moves"},
                             {.name = "probe", .repeated = true, .help = "a history of grains"},
                             {.name = "output", .completed = true, .help = "what is written with --out"}},
                  .keys = {}};
    for (const KeySpec& key : case_file_spec().keys)
      if (is_shared(key)) file.keys.push_back(key);
    for (const auto& more : {keys_of_bodies(), keys_of_collisions(), keys_of_walls(), keys_of_motion()})
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
