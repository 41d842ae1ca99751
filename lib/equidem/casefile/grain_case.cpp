// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/casefile/grain_case.hpp"

#include <algorithm>
#include <cmath>

#include "equidem/casefile/case_tables.hpp"
#include "equidem/casefile/engine/keys.hpp"
#include "equidem/casefile/engine/read_value.hpp"
#include "equidem/casefile/grain_bodies.hpp"
#include "equidem/casefile/grain_keys.hpp"
#include "equidem/casefile/grain_pairs.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/nearest.hpp"

namespace equidem {
using namespace casefile;
namespace {

namespace fs = std::filesystem;

TomlValue document_of(std::string_view content, const std::string& name, std::span<const std::string> overrides) {
  TomlValue root = parse_toml(content, name);
  for (const std::string& assignment : overrides) apply_override(root, assignment);
  return root;
}

/// The letters of the paper are known, and no names.
void check_letters(const TomlValue& root) {
  const TomlValue* collisions = root.find("collisions");
  const TomlValue* law = collisions == nullptr ? nullptr : collisions->find("law");
  if (law == nullptr) return;
  for (const LawDescription& meant : normal_laws())
    if (law->text == meant.letter)
      fail_at(*law, "collisions.law", fmt::format("{} is the letter of a law", law->shown()),
              "laws go by their names here", fmt::format("Write law = \"{}\"", meant.name));
}

Vec2 direction(const TomlValue& table, const char* key, const std::string& use) {
  const Vec2 given = vector(table, key);
  const double length = std::hypot(given.x, given.y);
  if (length == 0)
    fail_at(*table.find(key), fmt::format("wall.{}", key),
            fmt::format("the {} of wall '{}' is zero", key, text(table, "name")), use,
            "Give a direction, such as [0.0, 1.0]");
  return given / length;
}

void read_motion(const TomlValue& table, std::span<const NamedSchedule> schedules, Wall& wall) {
  const TomlValue* displacement = table.find("displacement");
  const TomlValue* along = table.find("direction");
  const TomlValue* schedule = table.find("schedule");
  if (displacement == nullptr || schedule == nullptr) {
    const TomlValue* lonely = displacement != nullptr ? displacement : schedule != nullptr ? schedule : along;
    if (lonely == nullptr) return;
    fail_at(*lonely, "wall",
            fmt::format("wall '{}' has no {}", wall.name, displacement == nullptr ? "displacement" : "schedule"),
            "a wall moves by its displacement times a schedule",
            displacement == nullptr ? "Add displacement = ... in m"
                                    : "Add schedule = \"NAME\" and a [[schedule]] of that name");
  }
  if (along == nullptr && wall.shape != Wall::Shape::line)
    fail_at(*displacement, "wall.displacement", fmt::format("wall '{}' has no direction", wall.name),
            "only a line moves along its normal by itself", "Add direction = [..., ...]");
  const Vec2 unit = along == nullptr ? wall.normal : direction(table, "direction", "it says where the wall moves");
  wall.move_x = scheduled(table, "wall", displacement->real * unit.x, schedules);
  wall.move_y = scheduled(table, "wall", displacement->real * unit.y, schedules);
}

Wall read_wall(const TomlValue& table, std::span<const NamedSchedule> schedules) {
  Wall wall;
  wall.name = text(table, "name");
  const std::string& shape = text(table, "shape");
  const char* culprit = "normal";
  if (shape == "line") {
    wall.shape = Wall::Shape::line;
    wall.point = vector(table, "point");
    wall.normal = direction(table, "normal", "it says on which side the grains are");
  } else if (shape == "segment") {
    wall.shape = Wall::Shape::segment;
    wall.point = vector(table, "point");
    wall.end = vector(table, "end");
    culprit = "end";
  } else {
    wall.shape = Wall::Shape::arc;
    wall.point = vector(table, "centre");
    wall.radius = number(table, "radius");
    wall.from = number(table, "from");
    wall.to = number(table, "to");
    culprit = "to";
  }
  try {
    check(wall);
  } catch (const Error& error) {
    throw error.at(fmt::format("{}: wall.{}", table.find(culprit)->where(), culprit));
  }
  read_motion(table, schedules, wall);
  return wall;
}

/// Names by which pairs are chosen mean one thing each.
void check_names_of_kinds(const TomlValue& root, const std::vector<std::string>& groups) {
  constexpr const char* reserved = "walls";
  for (const TomlValue& wall : repeated(root, "wall")) {
    const TomlValue& name = *wall.find("name");
    if (name.text == reserved)
      fail_at(name, "wall.name", "a wall is called 'walls'", "the name stands for all of them", "Name it otherwise");
    if (std::find(groups.begin(), groups.end(), name.text) != groups.end())
      fail_at(name, "wall.name", fmt::format("a wall and a group of grains are both called '{}'", name.text),
              "[[collisions.pair]] chooses them by name", "Rename one of them");
  }
  for (const TomlValue& grain : repeated(root, "grain"))
    if (text(grain, "group") == reserved)
      fail_at(*grain.find("group"), "grain.group", "a group of grains is called 'walls'",
              "the name stands for all walls", "Name it otherwise");
}

GrainProbe read_probe(const TomlValue& table, const std::vector<std::string>& groups) {
  check_plain_name(*table.find("name"), "probe.name", "a probe", "it begins the names of columns");
  GrainProbe probe{.name = text(table, "name"), .grains = {}, .quantities = {}};
  for (const TomlValue& word : table.find("quantities")->items) probe.quantities.push_back(word.text);
  const TomlValue* group = table.find("group");
  const TomlValue* grains = table.find("grains");
  if ((group == nullptr) == (grains == nullptr))
    fail_at(group != nullptr ? *grains : table, "probe",
            group != nullptr ? "group and grains are both given" : "it is not said whose history it is",
            "a probe watches a group, or grains by their numbers", "Give one of the two");
  if (grains != nullptr) {
    for (const TomlValue& item : grains->items) {
      if (static_cast<std::size_t>(item.integer) >= groups.size())
        fail_at(item, "probe.grains", fmt::format("there is no grain {}", item.integer),
                fmt::format("they are counted 0 to {}", groups.size() - 1), "Correct the number");
      probe.grains.push_back(static_cast<std::int32_t>(item.integer));
    }
    return probe;
  }
  for (std::size_t g = 0; g < groups.size(); ++g)
    if (groups[g] == group->text) probe.grains.push_back(static_cast<std::int32_t>(g));
  if (probe.grains.empty()) {
    const auto meant = nearest(group->text, groups);
    fail_at(*group, "probe.group", fmt::format("there are no grains of the group {}", group->shown()), "",
            meant ? fmt::format("Did you mean \"{}\"?", *meant) : "Name a group of [[grain]]");
  }
  return probe;
}

void read_ellipse_contact(const TomlValue& collisions, GrainCase& result) {
  const TomlValue* given = collisions.find("ellipse_contact");
  if (given == nullptr) return;
  const auto is_ellipse = [](const Grain& grain) { return grain.shape() == GrainShape::ellipse; };
  if (std::ranges::none_of(result.scene.grains, is_ellipse))
    fail_at(*given, "collisions.ellipse_contact", "ellipse_contact is given without ellipses",
            "discs have no need of it", "Remove it, or give grains half_axes");
  using enum GrainOptions::EllipseLaw;
  result.options.ellipse_law = given->text == "exact"      ? exact
                               : given->text == "enlarged" ? enlarged_mended
                                                           : enlarged_as_printed;
}

void read_run(const TomlValue& run, GrainCase& result) {
  result.duration = number(run, "duration");
  result.scene.gravity = vector(run, "gravity");
  const TomlValue& step = *run.find("time_step");
  const TomlValue* per_contact = run.find("steps_per_contact");
  result.step.longest = result.duration;
  result.step.steps_per_contact = optional_number(run, "steps_per_contact");
  if (step.is_number()) {
    result.step.time_step = step.real;
    if (per_contact != nullptr)
      fail_at(*per_contact, "run.steps_per_contact", "time_step and steps_per_contact are both given",
              "each says how long a step is", "Remove one of them");
    if (step.real > result.duration)
      fail_at(step, "run.time_step",
              fmt::format("time_step = {} s is longer than the run of {} s", step.real, result.duration),
              "a run makes at least one step", "Shorten the step");
  }
  const TomlValue* scheme = run.find("scheme");
  if (scheme == nullptr) return;
  if (!gives_force(result.options.law))
    fail_at(*scheme, "run.scheme", fmt::format("{} has a step of its own", to_string(result.options.law)),
            "scheme is for the laws that give a force: " + names_of_laws(LawKind::force),
            "Remove it, or change collisions.law");
  if (scheme->text == "velocity_verlet") result.options.scheme = GrainOptions::Scheme::velocity_verlet;
  if (scheme->text == "corrected_verlet") result.options.scheme = GrainOptions::Scheme::corrected_verlet;
}

}  // namespace

std::string GrainCase::where(std::string_view key) const {
  return fmt::format("{}: {}", value_at(document, key).where(), key);
}

std::string GrainCase::where_grain(std::size_t grain) const {
  if (grain < grain_lines.size()) return fmt::format("{}:{}", grain_file, grain_lines[grain]);
  return fmt::format("{}: grain", repeated(document, "grain")[grain - grain_lines.size()].where());
}

bool describes_grains(const fs::path& path, std::span<const std::string> overrides) {
  return describes_grains(document_of(read_file(path), path.string(), overrides));
}

GrainCase parse_grain_case(std::string_view content, const std::string& name, const fs::path& folder,
                           std::span<const std::string> overrides) {
  TomlValue root = document_of(content, name, overrides);
  check_letters(root);
  check_and_complete(root, grain_file_spec());
  GrainCase result;
  result.title = text(root, "title");
  for (const char* list : {"wall", "schedule", "probe"}) check_names(root, list);
  GrainBodies bodies = read_bodies(root, folder);
  result.body = bodies.body;
  result.scene.grains = std::move(bodies.grains);
  result.densities = std::move(bodies.densities);
  result.scene.clumps = std::move(bodies.clumps);
  result.grain_file = std::move(bodies.file);
  result.grain_lines = std::move(bodies.lines);
  BondCase bonds = read_bonds(root, folder, result.scene.grains.size());
  result.scene.bonds = std::move(bonds.bonds);
  result.options.bond_step = bonds.step;
  check_names_of_kinds(root, bodies.groups);
  std::vector<ScheduleTable> schedule_tables;
  if (TomlValue* list = root.find("schedule"))
    for (TomlValue& table : list->items) read_table(schedule_keys(), table, folder, schedule_tables.emplace_back());
  const auto schedules = read_schedules(root, schedule_tables);
  for (const TomlValue& table : repeated(root, "wall")) result.scene.walls.push_back(read_wall(table, schedules));
  const TomlValue& collisions = *root.find("collisions");
  result.options.law = normal_law_from(text(collisions, "law"));
  read_ellipse_contact(collisions, result);
  result.options.reference_length = optional_number(collisions, "reference_length").value_or(0);
  read_collisions(root, bodies.groups, result);
  read_run(*root.find("run"), result);
  if (root.find("shaking") != nullptr) result.shaking = read_shaking(root, folder, result.duration, result.scene.walls);
  if (const TomlValue* table = root.find("measures")) result.measures = read_measures(*table, result.body);
  for (const TomlValue& table : repeated(root, "probe")) result.probes.push_back(read_probe(table, bodies.groups));
  const TomlValue& output = *root.find("output");
  result.output.csv = flag(output, "csv");
  result.output.picture = flag(output, "picture");
  result.output.frame_interval = optional_number(output, "frame_interval");
  result.output.probe_interval = optional_number(output, "probe_interval");
  result.output.checkpoint_interval = number(output, "checkpoint_interval");
  result.document = std::move(root);
  return result;
}

GrainCase read_grain_case(const fs::path& path, std::span<const std::string> overrides) {
  return parse_grain_case(read_file(path), path.string(), path.parent_path(), overrides);
}

}  // namespace equidem
