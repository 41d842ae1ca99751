// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// [[stage]]: a run in stages, and [shaking].
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "equidem/casefile/engine/bind.hpp"
#include "equidem/casefile/grains/grain_tables.hpp"
#include "equidem/core/names.hpp"
#include "equidem/core/text.hpp"
#include "equidem/grains/scene/grain_shapes.hpp"

namespace equidem::casefile {
namespace {

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

Shaking read_shaking(const TomlValue& table, const ShakingOptions& given, std::optional<double> duration) {
  if (!duration && !given.cycles && !given.duration)
    fail_at(table, "neither cycles nor duration is given", "the length of the stage is not given in seconds",
            "Give cycles or duration");
  return at_key(table, [&] { return shaking_of(given, duration.value_or(INFINITY)); });
}

/// [[stage.remove]]: which bodies; of [[stage.rename]] too.
struct BodyChoiceTable {
  std::optional<std::string> group;
  std::optional<Rectangle> box;  ///< m
};

/// [[stage.rename]]: bodies, or a wall.
struct BodyRenamingTable {
  BodyChoiceTable which;
  std::optional<std::string> wall;
  std::string to;
};
std::vector<Key<BodyChoiceTable>> choice_keys() {
  using C = BodyChoiceTable;
  return {key("group", &C::group, "those of this group; left out: of any"),
          key("box", &C::box, unit("m"), "those with their centre inside, where the stage begins; left out: anywhere")};
}

void check_no_wall(const TomlValue& group, const std::vector<Wall>& walls) {
  if (std::ranges::find(walls, group.text, &Wall::name) == walls.end()) return;
  fail_at(group, fmt::format("a wall and a group of grains are both called '{}'", group.text),
          "[[collisions.pair]] chooses them by name", "Give the group another name");
}

std::vector<Key<BodyRenamingTable>> renaming_keys() {
  using R = BodyRenamingTable;
  std::vector<Key<R>> keys = keys_of_member(&R::which, choice_keys());
  const std::string one = "one table renames bodies or a wall";
  keys.push_back(key("wall", &R::wall, not_beside({"group"}, one), not_beside({"box"}, one),
                     "instead of bodies: this wall, before [[stage.wall]] of the stage is read"));
  keys.push_back(key("to", &R::to, required,
                     "their group from now on, a new or an existing one, or the new name of the wall: contacts, "
                     "and histories of walls, go by it"));
  return keys;
}

/// All bodies of a run up to a stage, each as often as there are groups that it may have: their kinds and the masses
/// that meet in contacts do not depend on where bodies will be.
class StagePopulation {
 public:
  StagePopulation(const std::vector<Grain>& grains, const std::vector<std::string>& groups) : first_groups_(groups) {
    for (std::size_t k = 0; k < grains.size(); ++k) add(k, grains[k], groups[k]);
  }

  /// Go on to the next stage.
  /// \param[in,out] stage its table; paths become those that the program opens
  /// \param tables with the walls of all stages; get the densities of bodies that are added
  /// \return whether it changes bodies
  /// \throws Error (bad_input) with line and key: a choice of all bodies, a group that no body has, a box without area,
  ///         names that are not plain, bodies as those of the case
  bool read(const TomlValue& root, TomlValue& stage, const std::filesystem::path& folder, GrainShapes& shapes,
            GrainTables& tables) {
    removed_.clear();
    renamed_.clear();
    for (const TomlValue& table : repeated(stage, "remove")) {
      read_table(choice_keys(), table, removed_.emplace_back());
      check_choice(table, removed_.back());
    }
    for (const TomlValue& table : repeated(stage, "rename")) {
      BodyRenamingTable renaming;
      read_table(renaming_keys(), table, renaming);
      if (renaming.wall) continue;
      check_choice(table, renaming.which);
      check_group_name(*table.find("to"));
      check_no_wall(*table.find("to"), tables.scene.walls);
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
      check_no_wall(*table.find("group"), tables.scene.walls);
    }
    const GrainRows rows = bodies_of(root, stage, common, read, shapes, tables);
    for (std::size_t k = 0; k < rows.grains.size(); ++k) {
      add(first_groups_.size(), rows.grains[k], rows.groups[k]);
      first_groups_.push_back(rows.groups[k]);
      tables.densities.push_back(rows.densities[k]);
    }
    added_ = rows.grains.size();
    return added_ > 0 || !removed_.empty() || !renamed_.empty();
  }

  [[nodiscard]] const std::vector<Grain>& grains() const { return grains_; }
  [[nodiscard]] const std::vector<std::string>& groups() const { return groups_; }
  /// The groups of the bodies in which the run has them first.
  [[nodiscard]] const std::vector<std::string>& first_groups() const { return first_groups_; }
  /// Returns what was read last. \param grains those of the population, with their kinds
  [[nodiscard]] StageBodies changes(const std::vector<Grain>& grains) const {
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

 private:
  void add(std::size_t number, const Grain& grain, const std::string& group) {
    if (!entries_.try_emplace({number, group}, grains_.size()).second) return;
    grains_.push_back(grain);
    groups_.push_back(group);
    numbers_.push_back(number);
  }
  void check_choice(const TomlValue& table, const BodyChoiceTable& choice) const {
    if (!choice.group && !choice.box)
      fail_at(table, "neither a group nor a box is given", "all bodies would be chosen",
              table.path == "stage.rename"
                  ? "Give group = ... or box = [x_min, y_min, x_max, y_max], or the name of a wall"
                  : "Give group = ... or box = [x_min, y_min, x_max, y_max]");
    if (choice.box) check_box(*table.find("box"), choice.box->low, choice.box->high);
    if (!choice.group || std::ranges::find(groups_, *choice.group) != groups_.end()) return;
    const auto meant = nearest(*choice.group, groups_);
    fail_at(*table.find("group"), fmt::format("no grain has the group {} until then", table.find("group")->shown()), "",
            meant ? fmt::format("Did you mean \"{}\"?", *meant) : "Name a group of the grains");
  }
  [[nodiscard]] BodyChoice choice_of(const BodyChoiceTable& table, const std::vector<Grain>& grains) const {
    BodyChoice choice{.kinds = {}, .box = table.box};
    for (std::size_t k = 0; table.group && k < grains.size(); ++k)
      if (groups_[k] == *table.group && std::ranges::find(choice.kinds, grains[k].kind) == choice.kinds.end())
        choice.kinds.push_back(grains[k].kind);
    return choice;
  }

  std::vector<Grain> grains_;
  std::vector<std::string> groups_, first_groups_;
  std::vector<std::size_t> numbers_;
  std::map<std::pair<std::size_t, std::string>, std::size_t> entries_;
  // of the last stage
  std::vector<BodyChoiceTable> removed_;
  std::vector<BodyRenamingTable> renamed_;
  std::size_t added_ = 0;
};

/// [[stage.wall]]: a wall of another motion, or a new one.
struct StageWallTable {
  WallTable wall;
  bool removed = false;
  std::optional<Vec2> velocity;  ///< m/s
};

/// The keys of a wall, none of them required: a wall that is there gets another motion.
std::vector<Key<StageWallTable>> stage_wall_keys() {
  using W = StageWallTable;
  std::vector<Key<W>> keys = keys_of_member(&W::wall, wall_keys());
  for (Key<W>& key : keys) {
    if (key.spec.name != "name" && key.spec.is_required()) key.spec.fallback = KeySpec::none;
  }
  keys.push_back(key("removed", &W::removed, optional, "true: the wall is taken away"));
  keys.push_back(key("velocity", &W::velocity, unit("m/s"),
                     not_beside({"displacement"}, "each says how the wall moves"), "constant in this stage"));
  return keys;
}

auto find_named(auto& walls, const std::string& name) {
  return std::ranges::find(walls, name, &Wall::name);
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

/// The walls of a run, from stage to stage.
class StageWalls {
 public:
  /// \param walls of the case; \param tables that they were read from
  StageWalls(const std::vector<Wall>& walls, const std::vector<WallTable>& tables) : walls_(walls), all_(walls) {
    for (const WallTable& table : tables)
      if (!table.shaken) still_.insert(table.wall.name);
  }

  /// Go on to the next stage: walls are renamed, then changed.
  /// \throws Error (bad_input) with line and key: a wall that is not there or needed by the servo of another, a name
  ///         that a wall has or had, a wall that is renamed twice or renamed and removed, one that is there with a
  ///         place
  void read(const TomlValue& stage, std::span<const NamedSchedule> schedules) {
    check_names(stage, "wall");
    renamed_.clear();
    for (Wall& wall : walls_) {
      wall.move_x = wall.move_y = {};
      if (wall.servo) wall.servo->goes_on = true;
    }
    for (const TomlValue& table : repeated(stage, "rename")) rename(table);
    for (const TomlValue& table : repeated(stage, "wall")) {
      check_name(table);
      change(table, schedules);
      if (const TomlValue* shaken = table.find("shaken"))
        shaken->boolean ? void(still_.erase(table.find("name")->text)) : void(still_.insert(table.find("name")->text));
    }
    for (const TomlValue& table : repeated(stage, "wall"))
      if (const TomlValue* removed = table.find("removed"); removed != nullptr && removed->boolean)
        check_servos_of_others(table, table.find("name")->text, "removed");
    for (const TomlValue& table : repeated(stage, "rename"))
      if (const TomlValue* wall = table.find("wall")) check_servos_of_others(table, wall->text, "renamed");
    for (const Wall& wall : walls_)
      if (find_named(all_, wall.name) == all_.end()) all_.push_back(wall);
  }

  /// Those of the stage, without its shaking.
  [[nodiscard]] const std::vector<Wall>& walls() const { return walls_; }
  [[nodiscard]] const std::vector<WallRenaming>& renamed() const { return renamed_; }
  [[nodiscard]] bool shakes(const Wall& wall) const { return !still_.contains(wall.name); }
  /// Those of all stages so far, one of each name.
  [[nodiscard]] const std::vector<Wall>& all() const { return all_; }

 private:
  [[noreturn]] void refuse_unknown(const TomlValue& name, const char* what) const {
    const auto meant = nearest(name.text, names_of(walls_));
    fail_at(name, fmt::format("no wall {} stands in the stage before", name.shown()), "",
            meant ? fmt::format("Did you mean \"{}\"?", *meant) : fmt::format("{} a wall that stands there", what));
  }
  void rename(const TomlValue& table) {
    BodyRenamingTable read;
    read_table(renaming_keys(), table, read);
    if (!read.wall) return;
    const auto is_it = [&](const WallRenaming& other) { return other.from == *read.wall || other.to == *read.wall; };
    if (const auto other = std::ranges::find_if(renamed_, is_it); other != renamed_.end())
      fail_at(*table.find("wall"),
              fmt::format("wall '{}' gets the name '{}' and then another one", other->from, other->to),
              "it has one name in a stage", "Rename it once");
    const auto at = find_named(walls_, *read.wall);
    if (at == walls_.end()) refuse_unknown(*table.find("wall"), "Rename");
    check_plain_name(*table.find("to"), "a wall", "it stands in the names of columns");
    if (find_named(all_, read.to) != all_.end())
      fail_at(*table.find("to"),
              fmt::format("wall '{}' is called '{}' from now on, and a wall has or had that name", *read.wall, read.to),
              "histories and contacts go by the names of walls", "Give it another name");
    at->name = read.to;
    all_.push_back(*at);
    if (still_.erase(*read.wall) > 0) still_.insert(read.to);
    renamed_.push_back({*read.wall, read.to});
  }
  void check_name(const TomlValue& table) const {
    const std::string& name = table.find("name")->text;
    const TomlValue* removed = table.find("removed");
    for (const WallRenaming& renaming : renamed_) {
      if ((name == renaming.from || name == renaming.to) && removed != nullptr && removed->boolean)
        fail_at(table, fmt::format("wall '{}' is renamed and removed in one stage", renaming.from),
                "a wall that is gone has no name", "Remove one of them");
      if (name == renaming.from)
        fail_at(*table.find("name"), fmt::format("wall '{}' is called '{}' in this stage", renaming.from, renaming.to),
                "[[stage.rename]] comes before [[stage.wall]]", fmt::format("Write name = \"{}\"", renaming.to));
    }
  }
  void change(const TomlValue& table, std::span<const NamedSchedule> schedules) {
    StageWallTable read;
    read_table(stage_wall_keys(), table, read);
    const std::string& name = read.wall.wall.name;
    const auto at = find_named(walls_, name);
    if (read.removed) {
      if (at == walls_.end()) refuse_unknown(*table.find("name"), "Remove");
      for (const TomlEntry& entry : table.entries)
        if (entry.name != "name" && entry.name != "removed" && !is_default(entry))
          fail_at(entry.value, fmt::format("wall '{}' is removed, and {} is given", name, entry.name),
                  "nothing counts of a wall that is gone", "Remove one of them");
      walls_.erase(at);
      return;
    }
    Wall wall;
    if (at != walls_.end()) {
      for (const char* key : {"shape", "point", "normal", "end"})
        if (const TomlValue* given = table.find(key); given != nullptr && !is_default({key, *given}))
          fail_at(*given, fmt::format("wall '{}' is there already", name), "it stays where it is when a stage begins",
                  "Leave the key out, or give the new wall another name");
      wall = *at;
      wall.move_x = wall.move_y = {};
      wall.servo.reset();
      read.wall.wall = wall;
      set_motion(table, read.wall, schedules, wall);
      if (table.find("displacement") != nullptr)
        with_key(table, table.find("schedule") != nullptr ? "schedule" : "displacement", [&] { check_start(wall); });
    } else {
      if (find_named(all_, name) != all_.end())
        fail_at(*table.find("name"), fmt::format("wall '{}' is new, and an earlier one had that name", name),
                "histories and contacts go by the names of walls", "Give the new wall another name");
      for (const char* key :
           read.wall.wall.shape == Wall::Shape::line ? std::array{"point", "normal"} : std::array{"point", "end"})
        if (table.find(key) == nullptr)
          fail_at(table, key, "missing key",
                  fmt::format("'{}' is a new wall, and none of that name stands in the stage before", name),
                  fmt::format("Add {} = ... to [[stage.wall]], or correct the name", key));
      wall = wall_of(table, read.wall, schedules);
    }
    if (read.velocity) move_at(wall, *read.velocity);
    read_servo(table, schedules, wall);
    at == walls_.end() ? walls_.push_back(wall) : void(*at = wall);
  }
  void check_servos_of_others(const TomlValue& table, const std::string& name, const char* done) const {
    for (const Wall& wall : walls_) {
      if (!wall.servo) continue;
      const Servo& servo = *wall.servo;
      if (servo.mirror != name && servo.between[0] != name && servo.between[1] != name) continue;
      fail_at(table, fmt::format("wall '{}' is {}", name, done),
              fmt::format("the servo of wall '{}' {}", wall.name,
                          servo.mirror == name ? "moves it as its mirror" : "measures its length to it"),
              fmt::format("Give '{}' in [[stage.wall]] of this stage too, without that servo or with another one",
                          wall.name));
    }
  }

  std::vector<Wall> walls_, all_;
  std::vector<WallRenaming> renamed_;  ///< in this stage
  std::set<std::string> still_;        ///< names of walls that do not shake
};

/// The walls move by a shaking. \param shakes, place_of of the number of a wall
template <class Shakes, class Place>
void shake_walls(const TomlValue& table, const Shaking& shaking, std::span<Wall> walls, const Shakes& shakes,
                 const Place& place_of) {
  bool any = false;
  for (std::size_t k = 0; k < walls.size(); ++k) {
    if (!shakes(k)) continue;
    any = true;
    with_place(place_of(k), [&] { shake(walls.subspan(k, 1), shaking.direction, shaking.displacement); });
  }
  if (!any)
    fail_at(table, "there is no wall that shakes", "a box moves by its walls",
            walls.empty() ? "Add a [[wall]]" : "Leave out shaken = false where a wall belongs to the box");
}

/// [stage.until].
struct UntilTable {
  StageEnd end;
  std::optional<std::string> from, to, wall;
};

std::vector<Key<UntilTable>> until_keys() {
  using U = UntilTable;
  using E = StageEnd;
  const std::string way = "it is that of the distance of two walls, or of the cell",
                    at_rest =
                        "at rest: the kinetic energy is at most this share of the elastic one, or the mean unbalanced "
                        "force of a body, with its moment over its radius, of the mean contact force";
  return {key("kinetic", &U::end, &E::kinetic, optional, positive, at_rest),
          key("unbalanced", &U::end, &E::unbalanced, optional, positive, at_rest),
          key("strain", &U::end, &E::strain, optional, positive, only_with({"from", "component"}, way),
              "change of the distance of two walls over that at the start of the stage; or of a strain of the cell"),
          key("component", &U::end, &E::of_cell, only_with({"strain"}, way), not_beside({"from"}, way),
              "of the strain of the periodic cell, as in the histories"),
          key("from", &U::from, only_with({"to"}, way), "the two walls"),
          key("to", &U::to, only_with({"strain"}, way), "the two walls"),
          key("displacement", &U::end, &E::displacement, optional, unit("m"), positive,
              only_with({"wall"}, "a wall is named that moves"), "way of a wall since the start of the stage"),
          key("wall", &U::wall, only_with({"displacement"}, "it says whose way counts"), "that wall")};
}

/// The shaking of a stage; its walls move by it.
std::optional<Shaking> shake_stage(const TomlValue& stage, const std::optional<double>& duration,
                                   const StageWalls& standing, std::vector<Wall>& walls) {
  const TomlValue* table = stage.find("shaking");
  if (table == nullptr) return {};
  ShakingOptions read;
  read_table(shaking_keys(), *table, read);
  const Shaking shaking = read_shaking(*table, read, duration);
  for (const Wall& wall : walls)
    for (const Wall& owner : walls)
      if (standing.shakes(wall) && owner.servo && (owner.name == wall.name || owner.servo->mirror == wall.name) &&
          std::abs(dot(owner.servo->direction, shaking.direction)) > 1e-9)
        fail_at(*table, fmt::format("wall '{}' shakes along the direction of its servo", wall.name),
                "it cannot keep a force and a motion", "Shake across it, or give the wall shaken = false");
  shake_walls(
      *table, shaking, walls, [&](std::size_t k) { return standing.shakes(walls[k]); },
      [&](std::size_t) { return table->place(); });
  return shaking;
}

StageEnd end_of_stage(const TomlValue& stage, const std::vector<Wall>& walls, const std::optional<PeriodicCell>& cell) {
  const TomlValue* table = stage.find("until");
  if (table == nullptr) return {};
  UntilTable read;
  read_table(until_keys(), *table, read);
  StageEnd& end = read.end;
  const auto named = [&](const char* key, const std::optional<std::string>& name) {
    if (!name || find_named(walls, *name) != walls.end()) return name.value_or("");
    fail_at(*table->find(key), fmt::format("there is no wall '{}'", *name), "the stage ends by it",
            "Name a wall that stands in this stage");
  };
  if (end.of_cell && !(cell && cell->along == PeriodicCell::Along::xy))
    fail_at(*table->find("component"), "there is no cell that repeats along x and y", "its strain ends the stage",
            "Name two walls by from and to, or add [cell]");
  end.walls = {named("from", read.from), named("to", read.to)};
  end.wall = named("wall", read.wall);
  if (!end.given())
    fail_at(*table, "nothing is given that ends the stage", "its duration ends it without that table",
            "Give kinetic, unbalanced, strain or displacement, or leave it out");
  if (end.strain > 0 && !end.of_cell && end.walls[0] == end.walls[1])
    fail_at(*table->find("to"), "both walls are the same", "the distance of a wall to itself does not change",
            "Name two walls");
  if (end.strain > 0 && !end.of_cell) {
    const Wall &from = *find_named(walls, end.walls[0]), &to = *find_named(walls, end.walls[1]);
    const bool lines = from.shape == Wall::Shape::line && to.shape == Wall::Shape::line;
    if (!lines || norm(from.normal + to.normal) > 1e-9 || dot(to.point - from.point, from.normal) == 0)
      fail_at(*table->find("to"), fmt::format("the walls '{}' and '{}' do not face each other", from.name, to.name),
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
        fail_at(pairs[k], fmt::format("'{}' and '{}' are a pair twice", names(pairs[k]).first, names(pairs[k]).second),
                "two bodies meet in one way", "Keep one of them");
    const TomlValue& with = *pairs[k].find("with");
    const auto stands = [&](const StageCase& stage) {
      return find_named(stage.scene.walls, with.text) != stage.scene.walls.end();
    };
    if (find_named(all, with.text) == all.end() || std::ranges::any_of(to_come, stands)) continue;
    const std::vector<WallRenaming>& renamed = to_come.front().renamed_walls;
    const auto renaming = std::ranges::find(renamed, with.text, &WallRenaming::from);
    fail_at(with, fmt::format("no wall '{}' stands in this stage or a later one", with.text), "nothing would meet it",
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
  const auto refuse = [](const TomlValue* table, const char* name, const char* problem, const char* remedy) {
    const TomlValue* given = table == nullptr ? nullptr : table->find(name);
    if (given != nullptr)
      fail_at(*given, problem, "the run is in stages, and schedules count from the start of a stage", remedy);
  };
  for (const TomlValue& wall : repeated(root, "wall")) {
    refuse(&wall, "displacement", "a wall has a motion outside of the stages",
           "Give it in [[stage.wall]] of its stage");
    refuse(wall.find("servo"), "schedule", "a servo has a schedule outside of the stages",
           "Give it in [[stage.wall]] of its stage");
  }
  if (const TomlValue* cell = root.find("cell")) {
    refuse(cell, "motion", "the cell has rates outside of the stages", "Give them in [stage.cell.motion]");
    refuse(cell->find("servo"), "schedule", "stresses have a schedule outside of the stages",
           "Give it in [stage.cell.servo]");
  }
  refuse(&root, "shaking", "a run in stages has [shaking]", "Give [stage.shaking] in its stage");
}

}  // namespace

void complete_shaking(const TomlValue& root, GrainTables& tables) {
  const TomlValue& table = *root.find("shaking");
  tables.shaking = read_shaking(table, *tables.shaking_table, tables.duration);
  shake_walls(
      table, *tables.shaking, tables.scene.walls, [&](std::size_t k) { return tables.wall_tables[k].shaken; },
      [&](std::size_t k) { return repeated(root, "wall")[k].place(); });
}

void bind_stages(File<GrainTables>& file) {
  file.table("shaking", &GrainTables::shaking_table, "walls that move all alike: a box that shakes")
      .keys(shaking_keys());
  using S = StageCase;
  file.table("stage", &GrainCase::stages,
             "a part of the run, in place of run.duration; what it does not name stays as it was")
      .keys({key_in<S>("name", &S::name, required, "for reports"),
             key("duration", &S::duration, unit("s"), positive, or_instead({"steps"}, "a stage has a length"),
                 "its length, or with [stage.until] the limit at which a run stops that has not met it"),
             key("steps", &S::given_steps, from(1, 1000000000000), "instead: that number of steps"),
             key_in<S>("gravity", &S::scene, &GrainScene::gravity, optional, unit("m/s²"), "from now on")});
  file.table("stage.until", "what ends the stage; all that is given must hold").described(until_keys());
  file.table("stage.collisions", like("collisions"), "contacts from now on, where they differ from [collisions]")
      .described(changed_contact_keys());
  file.table("stage.bonds", like("bonds"), "bonds that are made where the stage begins, beside the existing ones")
      .described(stage_bond_keys());
  file.table("stage.shaking", like("shaking"), "the box shakes in this stage; times count from its start")
      .described(shaking_keys());
  bind_stage_cell(file);
  file.table("stage.remove", repeated_table, "bodies that are taken away where the stage begins, their bonds too")
      .described(choice_keys());
  file.table("stage.rename", repeated_table, like("stage.remove"),
             "bodies that get another group, after those that go; or a wall another name")
      .described(renaming_keys());
  file.table("stage.grains", like("grains"), "bodies of a file that come where the stage begins")
      .described(common_body_keys());
  file.table("stage.grain", repeated_table, like("grain"), "one body that comes; those of the file come before it")
      .described(grain_keys());
  file.table("stage.pair", repeated_table, like("collisions.pair"),
             "contacts of two groups, or of a group and a wall, from now on")
      .described(pair_keys());
  file.table("stage.wall", repeated_table, like("wall"),
             "an existing wall, which stands without a motion of its own in the stage, goes or moves; or a new one")
      .described(stage_wall_keys());
  file.table("stage.wall.servo", like("wall.servo"), "its schedule begins with the stage").described(servo_keys());
}

std::vector<Wall> read_stages(const TomlValue& root, std::span<const NamedSchedule> schedules, GrainTables& tables) {
  check_names(root, "stage");
  if (!tables.stages.empty()) refuse_beside_stages(root);
  StageWalls walls(tables.scene.walls, tables.wall_tables);
  std::optional<PeriodicCell> cell = tables.scene.cell;
  for (std::size_t k = 0; k < tables.stages.size(); ++k) {
    const TomlValue& table = root.find("stage")->items[k];
    check_plain_name(*table.find("name"), "a stage", "it stands in tables");
    walls.read(table, schedules);
    if (k == 0 && !walls.renamed().empty())
      fail_at(table, "rename", fmt::format("the first stage renames the wall '{}'", walls.renamed()[0].from),
              "it begins with the walls of the case", "Give it that name in [[wall]], or rename it in a later stage");
    cell = cell_of_stage(table, schedules, cell);
    StageCase& stage = tables.stages[k];
    if (const TomlValue* bonds = table.find("bonds")) stage.bonds = read_stage_bonds(*bonds, tables, k);
    stage.scene.walls = walls.walls();
    stage.renamed_walls = walls.renamed();
    stage.end = end_of_stage(table, stage.scene.walls, cell);
    stage.shaking = shake_stage(table, stage.duration, walls, stage.scene.walls);
    stage.scene.cell = cell;
    if (table.find("gravity") == nullptr)
      stage.scene.gravity = k == 0 ? tables.scene.gravity : tables.stages[k - 1].scene.gravity;
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
      fail_at(table, "the first stage changes the grains", "it begins with those of the case",
              "Give the case those grains, or do it in a later stage");
    changed.scene.grains = population.grains();
    check_stage_pairs(repeated(table, "pair"), all, std::span(tables.stages).subspan(k));
    const bool other_contacts = change_contacts(table, contacts_now, changed.collisions.contact);
    if (other_contacts || other_bodies || k == 0) complete_collisions(contacts_now, population.groups(), changed);
    StageCase& stage = tables.stages[k];
    stage.bodies = population.changes(changed.scene.grains);
    std::vector<Wall> walls = std::move(stage.scene.walls);
    for (Wall& wall : walls) wall.kind = find_named(changed.scene.walls, wall.name)->kind;
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
  check_names_of_walls(root, population.groups());
  for (const TomlValue& stage : repeated(root, "stage")) check_names_of_walls(stage, population.groups());
  groups = population.first_groups();
}

}  // namespace equidem::casefile
