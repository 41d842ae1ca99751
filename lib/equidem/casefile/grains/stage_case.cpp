// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// [[stage]]: a run in stages.
#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "equidem/casefile/engine/read_value.hpp"
#include "equidem/casefile/grains/stage_bodies_case.hpp"
#include "equidem/core/text.hpp"

namespace equidem::casefile {
namespace {

/// [stage.until].
struct UntilTable {
  std::optional<double> kinetic, unbalanced, strain, displacement;
  std::optional<std::string> from, to, wall;
  std::optional<StageEnd::CellStrain> component;
};

/// [[stage.wall]]: a wall of another motion, or a new one.
struct StageWallTable {
  WallTable wall;
  bool removed = false;
  std::optional<Vec2> velocity;  ///< m/s
};

std::vector<Key<UntilTable>> until_keys() {
  using U = UntilTable;
  const std::string way = "it is that of the distance of two walls, or of the cell";
  return {
      key("kinetic", &U::kinetic, positive, "at rest: the kinetic energy is at most this share of the elastic one"),
      key("unbalanced", &U::unbalanced, positive,
          "at rest: the mean unbalanced force of a body, with its moment over its radius, is at most this share of the "
          "mean contact force"),
      key("strain", &U::strain, positive, only_with({"from", "component"}, way),
          "change of the distance of two walls over that at the start of the stage; or of a strain of the cell"),
      key("component", &U::component, only_with({"strain"}, way), not_beside({"from"}, way),
          "of the strain of the periodic cell, as in the histories"),
      key("from", &U::from, only_with({"to"}, way), "one of the two walls"),
      key("to", &U::to, only_with({"strain"}, way), "and the other"),
      key("displacement", &U::displacement, unit("m"), positive, only_with({"wall"}, "a wall is named that moves"),
          "way of a wall since the start of the stage"),
      key("wall", &U::wall, only_with({"displacement"}, "it says whose way counts"), "that wall")};
}

/// The keys of a wall, none of them required: a wall that is there gets another motion.
std::vector<Key<StageWallTable>> stage_wall_keys() {
  std::vector<Key<StageWallTable>> keys;
  for (const Key<WallTable>& of_wall : wall_keys(BodyFamily::colliding)) {
    Key<StageWallTable>& key = keys.emplace_back();
    key.spec = of_wall.spec;
    if (key.spec.name == "name") {
      key.spec.help = "of a wall that is there: its motion in this stage, none where none is given; or of a new wall";
    } else if (key.spec.name == "shaken") {
      key.spec.help = "false: [stage.shaking] does not move it, in later stages neither";
    } else if (key.spec.is_required()) {
      key.spec.fallback = KeySpec::none;
    }
    if (of_wall.read)
      key.read = [read = of_wall.read](StageWallTable& table, TomlValue& value, const std::filesystem::path& folder) {
        read(table.wall, value, folder);
      };
  }
  keys.push_back(key("removed", &StageWallTable::removed, optional, "true: the wall is taken away"));
  keys.push_back(key("velocity", &StageWallTable::velocity, unit("m/s"),
                     not_beside({"displacement"}, "each says how the wall moves"), "constant in this stage"));
  return keys;
}

template <class Walls>
auto find_wall(Walls& walls, const std::string& name) {
  return std::ranges::find(walls, name, &Wall::name);
}

/// \throws Error where a servo needs a wall that goes
void check_removal(const TomlValue& table, const std::vector<Wall>& walls, const std::string& name) {
  for (const Wall& wall : walls) {
    if (!wall.servo) continue;
    const Servo& servo = *wall.servo;
    if (servo.mirror != name && servo.between[0] != name && servo.between[1] != name) continue;
    fail_at(table, "stage.wall", fmt::format("wall '{}' is removed", name),
            fmt::format("the servo of wall '{}' {}", wall.name,
                        servo.mirror == name ? "moves it as its mirror" : "measures its length to it"),
            fmt::format("Name '{}' in this stage too, without that servo", wall.name));
  }
}

/// The shape is the only key with a default that stands in every table of a wall.
bool is_default(const TomlEntry& entry) {
  return entry.name == "shape" && entry.value.text == to_string(Wall::Shape::line);
}

void move_at(Wall& wall, Vec2 velocity) {
  constexpr double longest = 1e9;  // s; a limit of the stage may be raised
  const auto ramp = [&](double speed) {
    return Schedule{.kind = Schedule::Kind::table, .times = {0, longest}, .values = {0, speed * longest}};
  };
  if (velocity.x != 0) wall.move_x = ramp(velocity.x);
  if (velocity.y != 0) wall.move_y = ramp(velocity.y);
}

/// Change the walls of the stage before by one [[stage.wall]].
/// \param known walls of all stages so far
void change_wall(const TomlValue& table, std::span<const NamedSchedule> schedules, const std::vector<Wall>& known,
                 std::vector<Wall>& walls) {
  StageWallTable read;
  read_table(stage_wall_keys(), table, read);
  const std::string& name = read.wall.wall.name;
  const auto at = find_wall(walls, name);
  if (read.removed) {
    if (at == walls.end())
      fail_at(table, "stage.wall", fmt::format("there is no wall '{}'", name), "",
              "Remove a wall that stands in the stage before");
    for (const TomlEntry& entry : table.entries)
      if (entry.name != "name" && entry.name != "removed" && !is_default(entry))
        fail_at(entry.value, fmt::format("stage.wall.{}", entry.name),
                fmt::format("wall '{}' is removed and has a {}", name, entry.name), "a wall that is gone does not move",
                "Remove one of them");
    walls.erase(at);
    return;
  }
  Wall wall;
  if (at != walls.end()) {
    for (const char* key : {"shape", "point", "normal", "end", "centre", "radius"})
      if (const TomlValue* given = table.find(key); given != nullptr && !is_default({key, *given}))
        fail_at(*given, fmt::format("stage.wall.{}", key), fmt::format("wall '{}' is there already", name),
                "it stays where it is when a stage begins", "Leave the key out, or give the new wall another name");
    wall = *at;
    wall.move_x = wall.move_y = {};
    wall.servo.reset();
    read.wall.wall = wall;
    set_motion(table, "stage.wall", read.wall, schedules, wall);
    if (table.find("displacement") != nullptr)
      with_key(table, "stage.wall", table.find("schedule") != nullptr ? "schedule" : "displacement",
               [&] { check_start(wall); });
  } else {
    if (find_wall(known, name) != known.end())
      fail_at(table, "stage.wall.name", fmt::format("wall '{}' is new, and an earlier one had that name", name),
              "histories and contacts go by the names of walls", "Give the new wall another name");
    for (const char* key : read.wall.wall.shape == Wall::Shape::line      ? std::array{"point", "normal"}
                           : read.wall.wall.shape == Wall::Shape::segment ? std::array{"point", "end"}
                                                                          : std::array{"centre", "radius"})
      if (table.find(key) == nullptr)
        fail_at(table, fmt::format("stage.wall.{}", key), "missing key",
                fmt::format("'{}' is a new wall, and none of that name stands in the stage before", name),
                fmt::format("Add {} = ... to [[stage.wall]], or correct the name", key));
    wall = wall_of(table, "stage.wall", read.wall, schedules);
  }
  if (read.velocity) move_at(wall, *read.velocity);
  read_servo(table, "stage.wall", schedules, wall);
  at == walls.end() ? walls.push_back(wall) : void(*at = wall);
}

/// The walls of a stage, from those of the stage before.
/// \param[in,out] still names of walls that do not shake
std::vector<Wall> walls_of_stage(const TomlValue& stage, std::span<const NamedSchedule> schedules,
                                 const std::vector<Wall>& known, std::set<std::string>& still,
                                 std::vector<Wall> walls) {
  check_names(stage, "wall");
  for (Wall& wall : walls) wall.move_x = wall.move_y = {};
  for (const TomlValue& table : repeated(stage, "wall")) {
    change_wall(table, schedules, known, walls);
    if (const TomlValue* shaken = table.find("shaken"))
      shaken->boolean ? void(still.erase(table.find("name")->text)) : void(still.insert(table.find("name")->text));
  }
  for (const TomlValue& table : repeated(stage, "wall"))
    if (const TomlValue* removed = table.find("removed"); removed != nullptr && removed->boolean)
      check_removal(table, walls, table.find("name")->text);
  return walls;
}

/// The shaking of a stage; its walls move by it.
std::optional<Shaking> shake_stage(TomlValue& stage, const std::filesystem::path& folder,
                                   const std::optional<double>& duration, const std::set<std::string>& still,
                                   std::vector<Wall>& walls) {
  TomlValue* table = stage.find("shaking");
  if (table == nullptr) return {};
  ShakingTable read;
  read_table_in_place(shaking_keys(), *table, folder, read);
  const Shaking shaking = read_shaking(*table, "stage.shaking", read, duration);
  bool any = false;
  for (Wall& wall : walls) {
    if (still.contains(wall.name)) continue;
    any = true;
    with_place(fmt::format("{}: stage.shaking", table->where()), [&] {
      shake({&wall, 1}, shaking.direction, shaking.motion.displacement);
    });
  }
  if (!any)
    fail_at(*table, "stage.shaking", "there is no wall that shakes", "a box moves by its walls",
            walls.empty() ? "Add a [[wall]]" : "Leave out shaken = false where a wall belongs to the box");
  return shaking;
}

StageEnd end_of_stage(const TomlValue& stage, std::vector<Wall>& walls, const std::optional<PeriodicCell>& cell) {
  StageEnd end;
  const TomlValue* table = stage.find("until");
  if (table == nullptr) return end;
  UntilTable read;
  read_table(until_keys(), *table, read);
  const auto named = [&](const char* key, const std::optional<std::string>& name) {
    if (!name || find_wall(walls, *name) != walls.end()) return name.value_or("");
    fail_at(*table->find(key), fmt::format("stage.until.{}", key), fmt::format("there is no wall '{}'", *name),
            "the stage ends by it", "Name a wall that stands in this stage");
  };
  end.kinetic = read.kinetic.value_or(StageEnd::infinite);
  end.unbalanced = read.unbalanced.value_or(StageEnd::infinite);
  end.strain = read.strain.value_or(0);
  end.of_cell = read.component;
  if (end.of_cell && !(cell && cell->along == PeriodicCell::Along::xy))
    fail_at(*table->find("component"), "stage.until.component", "there is no cell that repeats along x and y",
            "its strain ends the stage", "Name two walls by from and to, or add [cell]");
  end.walls = {named("from", read.from), named("to", read.to)};
  end.displacement = read.displacement.value_or(0);
  end.wall = named("wall", read.wall);
  if (!end.given())
    fail_at(*table, "stage.until", "nothing is given that ends the stage", "its duration ends it without that table",
            "Give kinetic, unbalanced, strain or displacement, or leave it out");
  if (end.strain > 0 && !end.of_cell && end.walls[0] == end.walls[1])
    fail_at(*table, "stage.until.to", "both walls are the same", "the distance of a wall to itself does not change",
            "Name two walls");
  if (end.strain > 0 && !end.of_cell) {
    const Wall &from = *find_wall(walls, end.walls[0]), &to = *find_wall(walls, end.walls[1]);
    const bool lines = from.shape == Wall::Shape::line && to.shape == Wall::Shape::line;
    if (!lines || norm(from.normal + to.normal) > 1e-9 || dot(to.point - from.point, from.normal) == 0)
      fail_at(*table, "stage.until.strain",
              fmt::format("the walls '{}' and '{}' do not face each other", from.name, to.name),
              "the strain is the change of the distance of two parallel lines", "Name two lines with opposite normals");
  }
  return end;
}

/// The keys of a table in place of those that another one has.
void replace_keys(TomlValue& table, const TomlValue& by) {
  for (const TomlEntry& entry : by.entries) {
    TomlValue* old = table.find(entry.name);
    old != nullptr ? void(*old = entry.value) : void(table.entries.push_back(entry));
  }
}

/// The document with the contacts of a stage. \return whether it differs
bool change_contacts(const TomlValue& stage, TomlValue& root, PairOptions& contact) {
  TomlValue& collisions = *root.find("collisions");
  const TomlValue* bodies = stage.find("collisions");
  if (bodies != nullptr) {
    replace_keys(collisions, *bodies);
    read_table(changed_contact_keys(), *bodies, contact);
  }
  const std::vector<TomlValue>& pairs = repeated(stage, "pair");
  if (pairs.empty()) return bodies != nullptr;
  if (collisions.find("pair") == nullptr) {
    TomlValue list;
    list.type = TomlValue::Type::array;
    collisions.entries.push_back({"pair", std::move(list)});
  }
  std::vector<TomlValue>& known = collisions.find("pair")->items;
  for (const TomlValue& pair : pairs) {
    const auto is_it = [&](const TomlValue& other) {
      return std::minmax(other.find("group")->text, other.find("with")->text) ==
             std::minmax(pair.find("group")->text, pair.find("with")->text);
    };
    const auto at = std::ranges::find_if(known, is_it);
    at == known.end() ? known.push_back(pair) : replace_keys(*at, pair);
  }
  return true;
}

/// Motions that a case in stages gives in its stages alone.
void refuse_beside_stages(const TomlValue& root) {
  const std::string why = "the run is in stages, and schedules count from the start of a stage";
  for (const TomlValue& wall : repeated(root, "wall")) {
    if (const TomlValue* given = wall.find("displacement"))
      fail_at(*given, "wall.displacement", "a wall has a motion outside of the stages", why,
              "Give it in [[stage.wall]] of its stage");
    const TomlValue* servo = wall.find("servo");
    if (servo == nullptr) continue;
    if (const TomlValue* given = servo->find("schedule"))
      fail_at(*given, "wall.servo.schedule", "a servo has a schedule outside of the stages", why,
              "Give it in [[stage.wall]] of its stage");
  }
  if (const TomlValue* shaking = root.find("shaking"))
    fail_at(*shaking, "shaking", "a run in stages has [shaking]", why, "Give [stage.shaking] in its stage");
}

}  // namespace

void bind_stages(File<GrainTables>& file) {
  using S = StageTable;
  file.table("stage", &GrainTables::stage_tables,
             "a part of the run, in place of run.duration; what it does not name stays as it was")
      .keys({key("name", &S::name, required, "for reports"),
             key("duration", &S::duration, unit("s"), positive, or_instead({"steps"}, "a stage has a length"),
                 "its length, or with [stage.until] the limit at which a run stops that has not met it"),
             key("steps", &S::steps, from(1, 1000000000000), "instead: that number of steps"),
             key("gravity", &S::gravity, unit("m/s²"), "from now on")});
  file.table("stage.until", "what ends the stage; all that is given must hold").described(until_keys());
  file.table("stage.collisions", "contacts from now on, where they differ from [collisions]")
      .described(changed_contact_keys());
  file.table("stage.bonds", "bonds that are made where the stage begins, beside those that there are")
      .described(stage_bond_keys());
  file.table("stage.shaking", "the box shakes in this stage; times count from its start").described(shaking_keys());
  bind_stage_cell(file);
  bind_stage_bodies(file);
  file.table("stage.pair", repeated_table, "contacts of two groups, or of a group and a wall, from now on")
      .described(pair_keys());
  file.table("stage.wall", repeated_table, "a wall that is new, goes, or moves otherwise; without a motion it stands")
      .described(stage_wall_keys());
  file.table("stage.wall.servo", "as [wall.servo]; its schedule begins with the stage").described(servo_keys());
}

std::vector<Wall> read_stages(TomlValue& root, const std::filesystem::path& folder,
                              std::span<const NamedSchedule> schedules, GrainTables& tables) {
  check_names(root, "stage");
  if (!tables.stage_tables.empty()) refuse_beside_stages(root);
  std::vector<Wall> all = tables.scene.walls, walls = all;
  std::optional<PeriodicCell> cell = tables.scene.cell;
  std::set<std::string> still;
  for (const WallTable& wall : tables.wall_tables)
    if (!wall.shaken) still.insert(wall.wall.name);
  for (std::size_t k = 0; k < tables.stage_tables.size(); ++k) {
    TomlValue& table = root.find("stage")->items[k];
    check_plain_name(*table.find("name"), "stage.name", "a stage", "it stands in tables");
    const StageTable& read = tables.stage_tables[k];
    walls = walls_of_stage(table, schedules, all, still, walls);
    cell = cell_of_stage(table, schedules, cell);
    StageCase& stage = tables.stages.emplace_back();
    stage.name = read.name;
    stage.duration = read.duration;
    stage.steps = read.steps;
    if (const TomlValue* bonds = table.find("bonds")) stage.bonds = read_stage_bonds(*bonds, tables, k);
    stage.end = end_of_stage(table, walls, cell);
    stage.scene.walls = walls;
    stage.shaking = shake_stage(table, folder, read.duration, still, stage.scene.walls);
    stage.scene.cell = cell;
    stage.scene.gravity = read.gravity.value_or(k == 0 ? tables.scene.gravity : tables.stages[k - 1].scene.gravity);
    tables.duration += stage.duration.value_or(INFINITY);
    for (const Wall& wall : walls)
      if (find_wall(all, wall.name) == all.end()) all.push_back(wall);
  }
  return all;
}

void complete_stages(TomlValue& root, const std::filesystem::path& folder, std::vector<std::string>& groups,
                     const std::vector<Wall>& all, GrainShapes& shapes, GrainTables& tables) {
  TomlValue contacts_now = root;
  GrainTables changed = tables;
  changed.scene.walls = all;
  StagePopulation population(tables.scene.grains, groups);
  for (std::size_t k = 0; k < tables.stages.size(); ++k) {
    TomlValue& table = root.find("stage")->items[k];
    const bool other_bodies = population.read(root, table, folder, shapes, changed);
    if (other_bodies && k == 0)
      fail_at(table, "stage", "the first stage changes the grains", "it begins with those of the case",
              "Give the case those grains, or do it in a later stage");
    changed.scene.grains = population.grains();
    const bool other_contacts = change_contacts(table, contacts_now, changed.collisions.contact);
    if (other_contacts || other_bodies || k == 0) complete_collisions(contacts_now, population.groups(), changed);
    StageCase& stage = tables.stages[k];
    stage.bodies = population.changes(changed.scene.grains);
    std::vector<Wall> walls = std::move(stage.scene.walls);
    for (Wall& wall : walls) wall.kind = find_wall(changed.scene.walls, wall.name)->kind;
    const Vec2 gravity = stage.scene.gravity;
    const std::optional<PeriodicCell> cell = stage.scene.cell;
    stage.scene = changed.scene;
    stage.scene.walls = std::move(walls);
    stage.scene.gravity = gravity;
    stage.scene.cell = cell;
    stage.contacts = changed.contacts;
  }
  for (StageCase& stage : tables.stages) stage.scene.clumps = shapes.clumps();
  tables.scene = tables.stages.front().scene;
  tables.contacts = tables.stages.front().contacts;
  tables.densities = changed.densities;
  check_names_of_walls(root, "wall", population.groups());
  for (const TomlValue& stage : repeated(root, "stage")) check_names_of_walls(stage, "stage.wall", population.groups());
  groups = population.first_groups();
}

}  // namespace equidem::casefile
