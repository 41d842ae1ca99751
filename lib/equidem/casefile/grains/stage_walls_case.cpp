// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/casefile/grains/stage_walls_case.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "equidem/casefile/engine/value.hpp"
#include "equidem/casefile/grains/stage_bodies_case.hpp"
#include "equidem/core/names.hpp"
#include "equidem/core/text.hpp"

namespace equidem::casefile {
namespace {

/// [[stage.wall]]: a wall of another motion, or a new one.
struct StageWallTable {
  WallTable wall;
  bool removed = false;
  std::optional<Vec2> velocity;  ///< m/s
};

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

}  // namespace

StageWalls::StageWalls(const std::vector<Wall>& walls, const std::vector<WallTable>& tables)
    : walls_(walls), all_(walls) {
  for (const WallTable& table : tables)
    if (!table.shaken) still_.insert(table.wall.name);
}

void StageWalls::check_servos_of_others(const TomlValue& table, const std::string& name, const char* path,
                                        const char* done) const {
  for (const Wall& wall : walls_) {
    if (!wall.servo) continue;
    const Servo& servo = *wall.servo;
    if (servo.mirror != name && servo.between[0] != name && servo.between[1] != name) continue;
    fail_at(table, path, fmt::format("wall '{}' is {}", name, done),
            fmt::format("the servo of wall '{}' {}", wall.name,
                        servo.mirror == name ? "moves it as its mirror" : "measures its length to it"),
            fmt::format("Give '{}' in [[stage.wall]] of this stage too, without that servo or with another one",
                        wall.name));
  }
}

void StageWalls::refuse_unknown(const TomlValue& name, const char* key, const char* what) const {
  const auto meant = nearest(name.text, names_of(walls_));
  fail_at(name, key, fmt::format("no wall {} stands in the stage before", name.shown()), "",
          meant ? fmt::format("Did you mean \"{}\"?", *meant) : fmt::format("{} a wall that stands there", what));
}

void StageWalls::rename(const TomlValue& table) {
  BodyRenamingTable read;
  read_table(renaming_keys(), table, read);
  if (!read.wall) return;
  const auto is_it = [&](const WallRenaming& other) { return other.from == *read.wall || other.to == *read.wall; };
  if (const auto other = std::ranges::find_if(renamed_, is_it); other != renamed_.end())
    fail_at(*table.find("wall"), "stage.rename.wall",
            fmt::format("wall '{}' gets the name '{}' and then another one", other->from, other->to),
            "it has one name in a stage", "Rename it once");
  const auto at = find_named(walls_, *read.wall);
  if (at == walls_.end()) refuse_unknown(*table.find("wall"), "stage.rename.wall", "Rename");
  check_plain_name(*table.find("to"), "stage.rename.to", "a wall", "it stands in the names of columns");
  if (find_named(all_, read.to) != all_.end())
    fail_at(*table.find("to"), "stage.rename.to",
            fmt::format("wall '{}' is called '{}' from now on, and a wall has or had that name", *read.wall, read.to),
            "histories and contacts go by the names of walls", "Give it another name");
  at->name = read.to;
  all_.push_back(*at);
  if (still_.erase(*read.wall) > 0) still_.insert(read.to);
  renamed_.push_back({*read.wall, read.to});
}

void StageWalls::check_name(const TomlValue& table) const {
  const std::string& name = table.find("name")->text;
  const TomlValue* removed = table.find("removed");
  for (const WallRenaming& renaming : renamed_) {
    if ((name == renaming.from || name == renaming.to) && removed != nullptr && removed->boolean)
      fail_at(table, "stage.wall", fmt::format("wall '{}' is renamed and removed in one stage", renaming.from),
              "a wall that is gone has no name", "Remove one of them");
    if (name == renaming.from)
      fail_at(*table.find("name"), "stage.wall.name",
              fmt::format("wall '{}' is called '{}' in this stage", renaming.from, renaming.to),
              "[[stage.rename]] comes before [[stage.wall]]", fmt::format("Write name = \"{}\"", renaming.to));
  }
}

void StageWalls::change(const TomlValue& table, std::span<const NamedSchedule> schedules) {
  StageWallTable read;
  read_table(stage_wall_keys(), table, read);
  const std::string& name = read.wall.wall.name;
  const auto at = find_named(walls_, name);
  if (read.removed) {
    if (at == walls_.end()) refuse_unknown(*table.find("name"), "stage.wall.name", "Remove");
    for (const TomlEntry& entry : table.entries)
      if (entry.name != "name" && entry.name != "removed" && !is_default(entry))
        fail_at(entry.value, fmt::format("stage.wall.{}", entry.name),
                fmt::format("wall '{}' is removed, and {} is given", name, entry.name),
                "nothing counts of a wall that is gone", "Remove one of them");
    walls_.erase(at);
    return;
  }
  Wall wall;
  if (at != walls_.end()) {
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
    if (find_named(all_, name) != all_.end())
      fail_at(*table.find("name"), "stage.wall.name",
              fmt::format("wall '{}' is new, and an earlier one had that name", name),
              "histories and contacts go by the names of walls", "Give the new wall another name");
    for (const char* key :
         read.wall.wall.shape == Wall::Shape::line ? std::array{"point", "normal"} : std::array{"point", "end"})
      if (table.find(key) == nullptr)
        fail_at(table, fmt::format("stage.wall.{}", key), "missing key",
                fmt::format("'{}' is a new wall, and none of that name stands in the stage before", name),
                fmt::format("Add {} = ... to [[stage.wall]], or correct the name", key));
    wall = wall_of(table, "stage.wall", read.wall, schedules);
  }
  if (read.velocity) move_at(wall, *read.velocity);
  read_servo(table, "stage.wall", schedules, wall);
  at == walls_.end() ? walls_.push_back(wall) : void(*at = wall);
}

void StageWalls::read(const TomlValue& stage, std::span<const NamedSchedule> schedules) {
  check_names(stage, "wall", "stage.");
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
      check_servos_of_others(table, table.find("name")->text, "stage.wall", "removed");
  for (const TomlValue& table : repeated(stage, "rename"))
    if (const TomlValue* wall = table.find("wall"))
      check_servos_of_others(table, wall->text, "stage.rename", "renamed");
  for (const Wall& wall : walls_)
    if (find_named(all_, wall.name) == all_.end()) all_.push_back(wall);
}

void bind_stage_walls(File<GrainTables>& file) {
  file.table("stage.wall", repeated_table, "a wall that is new, goes, or moves otherwise; without a motion it stands")
      .described(stage_wall_keys());
  file.table("stage.wall.servo", "as [wall.servo]; its schedule begins with the stage").described(servo_keys());
}

}  // namespace equidem::casefile
