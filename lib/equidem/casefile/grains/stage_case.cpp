// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// [[stage]]: a run in stages.
#include <algorithm>
#include <cmath>
#include <utility>

#include "equidem/casefile/engine/value.hpp"
#include "equidem/casefile/grains/stage_bodies_case.hpp"
#include "equidem/casefile/grains/stage_walls_case.hpp"
#include "equidem/core/text.hpp"

namespace equidem::casefile {
namespace {

/// [stage.until].
struct UntilTable {
  std::optional<double> kinetic, unbalanced, strain, displacement;
  std::optional<std::string> from, to, wall;
  std::optional<StageEnd::CellStrain> component;
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

template <class Walls>
auto find_wall(Walls& walls, const std::string& name) {
  return std::ranges::find(walls, name, &Wall::name);
}

/// The shaking of a stage; its walls move by it.
std::optional<Shaking> shake_stage(const TomlValue& stage, const std::optional<double>& duration,
                                   const StageWalls& standing, std::vector<Wall>& walls) {
  const TomlValue* table = stage.find("shaking");
  if (table == nullptr) return {};
  ShakingOptions read;
  read_table(shaking_keys(), *table, read);
  const Shaking shaking = read_shaking(*table, "stage.shaking", read, duration);
  bool any = false;
  for (Wall& wall : walls) {
    if (!standing.shakes(wall)) continue;
    any = true;
    for (const Wall& owner : walls)
      if (owner.servo && (owner.name == wall.name || owner.servo->mirror == wall.name) &&
          std::abs(dot(owner.servo->direction, shaking.direction)) > 1e-9)
        fail_at(*table, "stage.shaking", fmt::format("wall '{}' shakes along the direction of its servo", wall.name),
                "it cannot keep a force and a motion", "Shake across it, or give the wall shaken = false");
    with_place(fmt::format("{}: stage.shaking", table->where()), [&] {
      shake({&wall, 1}, shaking.direction, shaking.displacement);
    });
  }
  if (!any)
    fail_at(*table, "stage.shaking", "there is no wall that shakes", "a box moves by its walls",
            walls.empty() ? "Add a [[wall]]" : "Leave out shaken = false where a wall belongs to the box");
  return shaking;
}

StageEnd end_of_stage(const TomlValue& stage, const std::vector<Wall>& walls, const std::optional<PeriodicCell>& cell) {
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
    fail_at(*table->find("to"), "stage.until.to", "both walls are the same",
            "the distance of a wall to itself does not change", "Name two walls");
  if (end.strain > 0 && !end.of_cell) {
    const Wall &from = *find_wall(walls, end.walls[0]), &to = *find_wall(walls, end.walls[1]);
    const bool lines = from.shape == Wall::Shape::line && to.shape == Wall::Shape::line;
    if (!lines || norm(from.normal + to.normal) > 1e-9 || dot(to.point - from.point, from.normal) == 0)
      fail_at(*table->find("to"), "stage.until.to",
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

/// Pairs of a stage name walls that stand from then on, and each two once.
/// \param all walls of all stages; \param to_come the stage and later ones
void check_stage_pairs(const std::vector<TomlValue>& pairs, const std::vector<Wall>& all,
                       std::span<const StageCase> to_come) {
  const auto names = [](const TomlValue& pair) {
    return std::minmax(pair.find("group")->text, pair.find("with")->text);
  };
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    for (std::size_t earlier = 0; earlier < k; ++earlier)
      if (names(pairs[earlier]) == names(pairs[k]))
        fail_at(pairs[k], "stage.pair",
                fmt::format("'{}' and '{}' are a pair twice", names(pairs[k]).first, names(pairs[k]).second),
                "two bodies meet in one way", "Keep one of them");
    const TomlValue& with = *pairs[k].find("with");
    const auto stands = [&](const StageCase& stage) {
      return find_wall(stage.scene.walls, with.text) != stage.scene.walls.end();
    };
    if (find_wall(all, with.text) == all.end() || std::ranges::any_of(to_come, stands)) continue;
    const std::vector<WallRenaming>& renamed = to_come.front().renamed_walls;
    const auto renaming = std::ranges::find(renamed, with.text, &WallRenaming::from);
    fail_at(with, "stage.pair.with", fmt::format("no wall '{}' stands in this stage or a later one", with.text),
            "nothing would meet it",
            renaming != renamed.end() ? fmt::format("Write with = \"{}\", its new name", renaming->to)
                                      : "Name a wall that stands, or remove the pair");
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
  bind_stage_walls(file);
}

std::vector<Wall> read_stages(const TomlValue& root, std::span<const NamedSchedule> schedules, GrainTables& tables) {
  check_names(root, "stage");
  if (!tables.stage_tables.empty()) refuse_beside_stages(root);
  StageWalls walls(tables.scene.walls, tables.wall_tables);
  std::optional<PeriodicCell> cell = tables.scene.cell;
  for (std::size_t k = 0; k < tables.stage_tables.size(); ++k) {
    const TomlValue& table = root.find("stage")->items[k];
    check_plain_name(*table.find("name"), "stage.name", "a stage", "it stands in tables");
    const StageTable& read = tables.stage_tables[k];
    walls.read(table, schedules);
    if (k == 0 && !walls.renamed().empty())
      fail_at(table, "stage.rename", fmt::format("the first stage renames the wall '{}'", walls.renamed()[0].from),
              "it begins with the walls of the case", "Give it that name in [[wall]], or rename it in a later stage");
    cell = cell_of_stage(table, schedules, cell);
    StageCase& stage = tables.stages.emplace_back();
    stage.name = read.name;
    stage.duration = read.duration;
    stage.steps = read.steps;
    if (const TomlValue* bonds = table.find("bonds")) stage.bonds = read_stage_bonds(*bonds, tables, k);
    stage.scene.walls = walls.walls();
    stage.renamed_walls = walls.renamed();
    stage.end = end_of_stage(table, stage.scene.walls, cell);
    stage.shaking = shake_stage(table, read.duration, walls, stage.scene.walls);
    stage.scene.cell = cell;
    stage.scene.gravity = read.gravity.value_or(k == 0 ? tables.scene.gravity : tables.stages[k - 1].scene.gravity);
    tables.duration += stage.duration.value_or(INFINITY);
  }
  return walls.all();
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
    check_stage_pairs(repeated(table, "pair"), all, std::span(tables.stages).subspan(k));
    const bool other_contacts = change_contacts(table, contacts_now, changed.collisions.contact);
    if (other_contacts || other_bodies || k == 0)
      complete_collisions(contacts_now, population.groups(), changed, &table);
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
