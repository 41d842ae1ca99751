// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/casefile/grains/grain_case.hpp"

#include <algorithm>
#include <cmath>

#include "equidem/casefile/engine/read_value.hpp"
#include "equidem/casefile/grains/grain_tables.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/names.hpp"

namespace equidem {
namespace {

namespace fs = std::filesystem;
using namespace casefile;

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
    if (grain.find("group")->text == reserved)
      fail_at(*grain.find("group"), "grain.group", "a group of grains is called 'walls'",
              "the name stands for all walls", "Name it otherwise");
}

/// A probe of a group has its bodies.
Probe probe_of(const TomlValue& table, Probe probe, const std::vector<std::string>& groups) {
  check_bodies(table, probe, groups.size());
  const TomlValue* group = table.find("group");
  if (group == nullptr) return probe;
  for (std::size_t g = 0; g < groups.size(); ++g)
    if (groups[g] == probe.group) probe.bodies.push_back(static_cast<std::int32_t>(g));
  if (probe.bodies.empty()) {
    const auto meant = nearest(probe.group, groups);
    fail_at(*group, "probe.group", fmt::format("there are no grains of the group {}", group->shown()), "",
            meant ? fmt::format("Did you mean \"{}\"?", *meant) : "Name a group of [[grain]]");
  }
  return probe;
}

void check_ellipse_contact(const TomlValue& collisions, const GrainScene& scene) {
  const TomlValue* given = collisions.find("ellipse_contact");
  const auto is_ellipse = [](const Grain& grain) { return grain.shape() == GrainShape::ellipse; };
  if (given != nullptr && std::ranges::none_of(scene.grains, is_ellipse))
    fail_at(*given, "collisions.ellipse_contact", "ellipse_contact is given without ellipses",
            "discs have no need of it", "Remove it, or give grains half_axes");
}

void complete_run(const TomlValue& run, GrainTables& tables) {
  const GrainRunTable& given = tables.run;
  if (given.given_step && given.steps_per_contact)
    fail_at(*run.find("steps_per_contact"), "run.steps_per_contact", "time_step and steps_per_contact are both given",
            "each says how long a step is", "Remove one of them");
  check_step(run, given);
  const TomlValue* integrator = run.find("integrator");
  if (integrator != nullptr && !gives_force(tables.options.law))
    fail_at(*integrator, "run.integrator", fmt::format("{} has a step of its own", to_string(tables.options.law)),
            "integrators are for the laws that give a force: " + names_of_laws(LawKind::force),
            "Remove it, or change collisions.law");
  tables.duration = *given.duration;
  tables.scene.gravity = given.gravity;
  tables.options.scheme = given.integrator;
  tables.step = {
      .time_step = given.given_step, .steps_per_contact = given.steps_per_contact, .longest = tables.duration};
}

void check_measures(const TomlValue& table, const MeasureOptions& measures, Body body) {
  if (body == Body::sphere)
    fail_at(table, "measures", "the bodies are spheres", "areas of the plane say nothing of their volumes",
            "Remove [measures], or take discs");
  if (!measures.region) return;
  const auto& [low, high] = *measures.region;
  if (!(low.x < high.x && low.y < high.y))
    fail_at(*table.find("region"), "measures.region", "the region has no area", "its lower left corner comes first",
            "Write it like [0.1, 0.1, 0.9, 0.5]");
}

}  // namespace

bool casefile::describes_grains(const TomlValue& root) {
  for (const char* table : {"grains", "grain", "collisions"}) {
    const TomlValue* found = root.find(table);
    if (found == nullptr) continue;
    if (root.find("assembly") == nullptr) return true;
    fail_at(*found, table, "grains that collide and [assembly] are both in the case",
            "contacts of an assembly are there from the start and stay", "Keep one of them");
  }
  return false;
}

std::string GrainCase::where(std::string_view key) const {
  return fmt::format("{}: {}", value_at(document, key).where(), key);
}

std::string GrainCase::where_grain(std::size_t grain) const {
  if (grain < grain_lines.size()) return fmt::format("{}:{}", grain_file, grain_lines[grain]);
  return fmt::format("{}: grain", casefile::repeated(document, "grain")[grain - grain_lines.size()].where());
}

bool describes_grains(const fs::path& path, std::span<const std::string> overrides) {
  return casefile::describes_grains(document_of(read_file(path), path.string(), overrides));
}

GrainCase parse_grain_case(std::string_view content, const std::string& name, const fs::path& folder,
                           std::span<const std::string> overrides) {
  TomlValue root = document_of(content, name, overrides);
  check_letters(root);
  refuse_energy_of_probes(root);
  grain_file().check(root);
  GrainTables tables;
  grain_file().assign(root, folder, tables);
  const std::vector<std::string> groups = read_bodies(root, tables);
  read_bonds(root, tables);
  check_names_of_kinds(root, groups);
  const auto schedules = read_schedules(root, tables.schedule_tables);
  tables.scene.walls = read_walls(root, tables.wall_tables, schedules);
  check_ellipse_contact(*root.find("collisions"), tables.scene);
  read_collisions(root, groups, tables);
  complete_run(*root.find("run"), tables);
  if (tables.shaking_table) tables.shaking = read_shaking(root, tables);
  if (tables.measures) check_measures(*root.find("measures"), *tables.measures, tables.body);
  check_probes(root);
  for (std::size_t k = 0; k < tables.probe_tables.size(); ++k)
    tables.probes.push_back(probe_of(repeated(root, "probe")[k], tables.probe_tables[k], groups));
  tables.document = std::move(root);
  return tables;
}

GrainCase read_grain_case(const fs::path& path, std::span<const std::string> overrides) {
  return parse_grain_case(read_file(path), path.string(), path.parent_path(), overrides);
}

}  // namespace equidem
