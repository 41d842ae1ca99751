// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/casefile/grains/stage_bodies_case.hpp"

#include <algorithm>

#include "equidem/casefile/engine/value.hpp"
#include "equidem/core/names.hpp"

namespace equidem::casefile {
namespace {

std::vector<Key<BodyChoiceTable>> choice_keys() {
  using C = BodyChoiceTable;
  return {key("group", &C::group, "those of this group; left out: of any"),
          key("box", &C::box, unit("m"), "those with their centre inside, where the stage begins; left out: anywhere")};
}

void check_no_wall(const TomlValue& group, const std::string& key, const std::vector<Wall>& walls) {
  if (std::ranges::find(walls, group.text, &Wall::name) == walls.end()) return;
  fail_at(group, key, fmt::format("a wall and a group of grains are both called '{}'", group.text),
          "[[collisions.pair]] chooses them by name", "Give the group another name");
}

}  // namespace

std::vector<Key<BodyRenamingTable>> renaming_keys() {
  std::vector<Key<BodyRenamingTable>> keys;
  for (const Key<BodyChoiceTable>& of_choice : choice_keys()) {
    Key<BodyRenamingTable>& key = keys.emplace_back();
    key.spec = of_choice.spec;
    key.read = [read = of_choice.read](BodyRenamingTable& table, TomlValue& value,
                                       const std::filesystem::path& folder) { read(table.which, value, folder); };
  }
  const std::string one = "one table renames bodies or a wall";
  keys.push_back(key("wall", &BodyRenamingTable::wall, not_beside({"group"}, one), not_beside({"box"}, one),
                     "instead of bodies: this wall, before [[stage.wall]] of the stage is read"));
  keys.push_back(key("to", &BodyRenamingTable::to, required,
                     "their group from now on, a new one or one that there is, or the new name of the wall: contacts, "
                     "and histories of walls, go by it"));
  return keys;
}

void bind_stage_bodies(File<GrainTables>& file) {
  file.table("stage.remove", repeated_table, "bodies that are taken away where the stage begins, their bonds too")
      .described(choice_keys());
  file.table("stage.rename", repeated_table,
             "bodies that get another group, after those that go; or a wall another name")
      .described(renaming_keys());
  file.table("stage.grains", "bodies of a file that come where the stage begins").described(common_body_keys());
  file.table("stage.grain", repeated_table, "one body that comes, as [[grain]]; those of the file come before it")
      .described(grain_keys());
}

StagePopulation::StagePopulation(const std::vector<Grain>& grains, const std::vector<std::string>& groups)
    : first_groups_(groups) {
  for (std::size_t k = 0; k < grains.size(); ++k) add(k, grains[k], groups[k]);
}

void StagePopulation::add(std::size_t number, const Grain& grain, const std::string& group) {
  if (!entries_.try_emplace({number, group}, grains_.size()).second) return;
  grains_.push_back(grain);
  groups_.push_back(group);
  numbers_.push_back(number);
}

void StagePopulation::check_choice(const TomlValue& table, const std::string& path,
                                   const BodyChoiceTable& choice) const {
  if (!choice.group && !choice.box)
    fail_at(table, path, "neither a group nor a box is given", "all bodies would be chosen",
            path == "stage.rename" ? "Give group = ... or box = [x_min, y_min, x_max, y_max], or the name of a wall"
                                   : "Give group = ... or box = [x_min, y_min, x_max, y_max]");
  if (choice.box) check_box(*table.find("box"), path + ".box", choice.box->low, choice.box->high);
  if (!choice.group || std::ranges::find(groups_, *choice.group) != groups_.end()) return;
  const auto meant = nearest(*choice.group, groups_);
  fail_at(*table.find("group"), path + ".group",
          fmt::format("no grain has the group {} until then", table.find("group")->shown()), "",
          meant ? fmt::format("Did you mean \"{}\"?", *meant) : "Name a group of the grains");
}

bool StagePopulation::read(const TomlValue& root, TomlValue& stage, const std::filesystem::path& folder,
                           GrainShapes& shapes, GrainTables& tables) {
  removed_.clear();
  renamed_.clear();
  for (const TomlValue& table : repeated(stage, "remove")) {
    read_table(choice_keys(), table, removed_.emplace_back());
    check_choice(table, "stage.remove", removed_.back());
  }
  for (const TomlValue& table : repeated(stage, "rename")) {
    BodyRenamingTable renaming;
    read_table(renaming_keys(), table, renaming);
    if (renaming.wall) continue;
    check_choice(table, "stage.rename", renaming.which);
    check_group_name(*table.find("to"), "stage.rename.to");
    check_no_wall(*table.find("to"), "stage.rename.to", tables.scene.walls);
    for (std::size_t k = 0, count = grains_.size(); k < count; ++k)
      if (!renaming.which.group || *renaming.which.group == groups_[k])
        add(numbers_[k], Grain(grains_[k]), renaming.to);
    renamed_.push_back(std::move(renaming));
  }
  CommonBodyTable common;
  if (TomlValue* table = stage.find("grains")) read_table_in_place(common_body_keys(), *table, folder, common);
  if (!common.density) common.density = tables.common.density;
  std::vector<GrainTable> read;
  for (const TomlValue& table : repeated(stage, "grain")) {
    read_table(grain_keys(), table, read.emplace_back());
    check_no_wall(*table.find("group"), "stage.grain.group", tables.scene.walls);
  }
  const GrainRows rows = bodies_of(root, stage, "stage.", common, read, shapes, tables);
  for (std::size_t k = 0; k < rows.grains.size(); ++k) {
    add(first_groups_.size(), rows.grains[k], rows.groups[k]);
    first_groups_.push_back(rows.groups[k]);
    tables.densities.push_back(rows.densities[k]);
  }
  added_ = rows.grains.size();
  return added_ > 0 || !removed_.empty() || !renamed_.empty();
}

BodyChoice StagePopulation::choice_of(const BodyChoiceTable& table, const std::vector<Grain>& grains) const {
  BodyChoice choice{.kinds = {}, .box = table.box};
  for (std::size_t k = 0; table.group && k < grains.size(); ++k)
    if (groups_[k] == *table.group && std::ranges::find(choice.kinds, grains[k].kind) == choice.kinds.end())
      choice.kinds.push_back(grains[k].kind);
  return choice;
}

StageBodies StagePopulation::changes(const std::vector<Grain>& grains) const {
  StageBodies bodies;
  for (const BodyChoiceTable& table : removed_) bodies.removed.push_back(choice_of(table, grains));
  for (const BodyRenamingTable& table : renamed_) {
    BodyRenaming& renaming = bodies.renamed.emplace_back();
    renaming.which = choice_of(table.which, grains);
    renaming.kinds.resize(first_groups_.size());
    for (std::size_t number = 0; number < first_groups_.size(); ++number)
      if (const auto at = entries_.find({number, table.to}); at != entries_.end())
        renaming.kinds[number] = grains[at->second].kind;
  }
  for (std::size_t number = first_groups_.size() - added_; number < first_groups_.size(); ++number)
    bodies.added.push_back(grains[entries_.at({number, first_groups_[number]})]);
  return bodies;
}

}  // namespace equidem::casefile
