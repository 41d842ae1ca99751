// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/casefile/grains/grain_case.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <vector>

#include "equidem/casefile/engine/bind.hpp"
#include "equidem/casefile/grains/grain_tables.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/names.hpp"

namespace equidem {
namespace {

namespace fs = std::filesystem;
using namespace casefile;

void check_stress(const TomlValue& table, const GrainTables& tables, const Probe& probe) {
  if (!has_stress(probe)) return;
  const auto refuse = [&](const char* what, const char* why, const char* advice) {
    fail_at(*table.find("quantities"), fmt::format("the probe '{}' has a stress {}", probe.name, what), why, advice);
  };
  if (!probe.box) refuse("and no box", "a stress is the mean over an area", "Add box = [x_min, y_min, x_max, y_max]");
  if (tables.body == Body::sphere)
    refuse("of spheres", "their forces have no width to act on",
           "Use discs, or divide forces of contacts.csv yourself");
  if (tables.scene.cell)
    refuse("in a periodic cell", "its box would have to repeat as the bodies do",
           "Remove it: history.csv has the stress of the cell");
}

/// A probe of a group has its bodies.
void choose_bodies(const TomlValue& table, const std::vector<std::string>& groups, Probe& probe) {
  check_bodies(table, probe, groups.size());
  if (probe.box) check_box(*table.find("box"), probe.box->low, probe.box->high);
  const TomlValue* group = table.find("group");
  if (group == nullptr) return;
  for (std::size_t g = 0; g < groups.size(); ++g)
    if (groups[g] == probe.group) probe.bodies.push_back(static_cast<std::int32_t>(g));
  if (!probe.bodies.empty()) return;
  const auto meant = nearest(probe.group, groups);
  fail_at(*group, fmt::format("there are no grains of the group {}", group->shown()), "",
          meant ? fmt::format("Did you mean \"{}\"?", *meant)
                : "Name a group that grains have where the run, or a stage that adds them, begins");
}

void check_ellipse_contact(const TomlValue& collisions, const GrainScene& scene) {
  const TomlValue* given = collisions.find("ellipse_contact");
  const auto is_ellipse = [](const Grain& grain) { return grain.shape() == GrainShape::ellipse; };
  if (given != nullptr && std::ranges::none_of(scene.grains, is_ellipse))
    fail_at(*given, "ellipse_contact is given without ellipses", "discs have no need of it",
            "Remove it, or give grains half_axes");
}

/// [collisions] and [[pair]] as they are given, those of stages too.
std::vector<TomlValue> tables_of_contacts(const TomlValue& root) {
  std::vector<TomlValue> tables;
  const auto collect = [&](const TomlValue& within) {
    if (const TomlValue* table = within.find("collisions")) tables.push_back(*table);
    std::ranges::copy(repeated(within, "pair"), std::back_inserter(tables));
  };
  collect(root);
  for (const TomlValue& stage : repeated(root, "stage")) collect(stage);
  return tables;
}

/// Some keys of contacts do nothing without another one. One table of contacts that gives it is enough, 0 too: others,
/// and the points of a sweep, may differ.
void refuse_idle_contact_keys(const std::vector<TomlValue>& tables) {
  struct Idle {
    const char* key;
    std::vector<std::string> needs;
    const char* why;
  };
  const std::vector<Idle> keys{
      {"tangential_ratio", {"friction"}, "the tangential spring carries nothing without friction"},
      {"tangential_damping",
       {"friction", "rolling_friction"},
       "the tangential dashpot carries nothing without friction"},
      {"rolling_ratio", {"rolling_friction"}, "the rolling spring carries nothing without rolling friction"},
      {"rolling_damping", {"rolling_friction"}, "the rolling dashpot carries nothing without rolling friction"},
      {"cohesion_range", {"cohesion"}, "bodies attract by a force within that range"}};
  for (const Idle& idle : keys) {
    const auto gives = [&](const TomlValue& table) {
      return std::ranges::any_of(idle.needs, [&](const std::string& key) { return table.find(key) != nullptr; });
    };
    if (std::ranges::any_of(tables, gives)) continue;
    for (const TomlValue& table : tables)
      if (const TomlValue* given = table.find(idle.key))
        fail_at(*given, fmt::format("{} is given without {}", idle.key, idle.needs.front()), idle.why,
                fmt::format("Add {} = ..., or remove it", idle.needs.front()));
  }
}

void take_run(GrainTables& tables) {
  const RunTable& run = tables.run;
  tables.duration = run.duration.value_or(0);
  tables.step = {.time_step = run.time_step.step, .steps_per_contact = run.steps_per_contact};
  tables.scene.gravity = run.gravity;
  tables.options.integrator = run.integrator_of_forces;
}

void complete_run(const TomlValue& run, GrainTables& tables) {
  if (tables.stages.empty() && run.find("duration") == nullptr)
    fail_at(run, "duration", "missing key", "a number in s, > 0 is needed",
            "Add duration = ... to [run], or [[stage]]");
  if (const TomlValue* given = run.find("duration"); given != nullptr && !tables.stages.empty())
    fail_at(*given, "duration and [[stage]] are both given", "stages have durations of their own",
            "Remove one of them");
  check_step(run, tables.step.time_step, tables.duration);
  const TomlValue* integrator = run.find("integrator");
  if (integrator != nullptr && !gives_force(tables.options.law))
    fail_at(*integrator, fmt::format("{} has a step of its own", to_string(tables.options.law)),
            "integrators are for the laws that give a force: " + names_of_laws(LawKind::force),
            "Remove it, or change collisions.law");
  tables.step.longest = tables.duration;
}

void check_stresses(const TomlValue& root, const GrainTables& tables) {
  if (tables.body == Body::disc) return;
  const auto check = [&](const std::vector<Wall>& walls) {
    for (const Wall& wall : walls)
      if (wall.servo && wall.servo->is_stress)
        fail_at(*root.find("grains"), "body", fmt::format("wall '{}' holds a stress and meets spheres", wall.name),
                "their forces are N, and a length in the plane is no area", "Give force in [wall.servo]");
  };
  check(tables.scene.walls);
  for (const StageCase& stage : tables.stages) check(stage.scene.walls);
}

/// The error of the library with the line of the option that it names.
Error placed(const Error& error, const GrainCase& resolved) {
  const std::string& option = error.where();
  const std::string key = option == "law"     ? "collisions.law"
                          : option == "bonds" ? resolved.document.find("bonds") != nullptr ? "bonds" : "bond"
                                              : "run." + option;
  return {error.kind(), error.problem(), error.why(), error.remedy(), resolved.where(key)};
}

}  // namespace

bool describes_grains(const TomlValue& root) {
  for (const char* table : {"grains", "grain", "collisions"}) {
    const TomlValue* found = root.find(table);
    if (found == nullptr) continue;
    if (root.find("assembly") == nullptr) return true;
    fail_at(*found, "grains that collide and [assembly] are both in the case",
            "contacts of an assembly are there from the start and stay", "Keep one of them");
  }
  return false;
}

std::vector<Grain> GrainCase::bodies() const {
  std::vector<Grain> all = scene.grains;
  for (const StageCase& stage : stages) all.insert(all.end(), stage.bodies.added.begin(), stage.bodies.added.end());
  return all;
}

std::string GrainCase::where_grain(std::size_t grain) const {
  if (grain < grain_lines.size()) return fmt::format("{}:{}", grain_file, grain_lines[grain]);
  return fmt::format("{}: grain", repeated(document, "grain")[grain - grain_lines.size()].where());
}

GrainCase parse_grain_case(std::string_view content, const std::string& name, const fs::path& folder,
                           std::span<const std::string> overrides) {
  TomlValue root = parse_document(content, name, overrides);
  resolve_springs_file(root, folder);
  resolve_strength_file(root, folder, CaseKind::colliding);
  const std::vector<TomlValue> contacts = tables_of_contacts(root);
  GrainTables tables = grain_file().read(root, folder);
  refuse_idle_contact_keys(contacts);
  take_run(tables);
  tables.common.density = one_density(
      root, {{"grains", tables.common.density}, {"springs", tables.springs ? tables.springs->density : std::nullopt}});
  GrainShapes shapes(tables.body);
  tables.groups = complete_bodies(root, shapes, tables);
  complete_bonds(root, tables);
  check_names_of_walls(root, tables.groups);
  const auto schedules = read_schedules(root, tables.schedule_tables);
  tables.scene.walls = read_walls(root, tables.wall_tables, schedules);
  complete_cell(root, schedules, tables);
  check_ellipse_contact(*root.find("collisions"), tables.scene);
  const std::vector<Wall> all_walls = read_stages(root, schedules, tables);
  if (tables.stages.empty()) {
    complete_collisions(root, tables.groups, tables);
  } else {
    complete_stages(root, folder, tables.groups, all_walls, shapes, tables);
  }
  check_stresses(root, tables);
  complete_run(*root.find("run"), tables);
  if (tables.shaking_table) complete_shaking(root, tables);
  if (tables.measures) at_key(*root.find("measures"), [&] { check(*tables.measures, tables.body); });
  check_probes(root);
  for (std::size_t k = 0; k < tables.probes.size(); ++k) {
    const TomlValue& table = repeated(root, "probe")[k];
    choose_bodies(table, tables.groups, tables.probes[k]);
    check_stress(table, tables, tables.probes[k]);
  }
  tables.document = std::move(root);
  return tables;
}

GrainCase read_grain_case(const fs::path& path, std::span<const std::string> overrides) {
  return parse_grain_case(read_file(path), path.string(), path.parent_path(), overrides);
}

GrainTimeStep choose_grain_step(const GrainCase& resolved) {
  try {
    GrainTimeStep chosen = choose_time_step(resolved.scene, resolved.contacts, resolved.options, resolved.step);
    GrainOptions options = resolved.options;
    options.reference_length = reference_length(resolved.scene, options);
    for (const StageCase& stage : resolved.stages) {
      const GrainTimeStep other = choose_time_step(stage.scene, stage.contacts, options, resolved.step);
      if (other.step < chosen.step) chosen = other;
      if (!stage.bonds) continue;
      const double limit = likely_step_limit(stage.scene.grains, *stage.bonds, options.bond_step);
      if (chosen.bond_limit == 0 || limit < chosen.bond_limit) chosen.bond_limit = std::isfinite(limit) ? limit : 0;
      if (chosen.automatic) chosen.step = std::min(chosen.step, 0.5 * limit);
    }
    return chosen;
  } catch (const Error& error) {
    throw placed(error, resolved);
  }
}

std::int64_t count_steps(const GrainCase& resolved, double step) {
  return with_place(resolved.where("run.duration"), [&] { return count_steps(resolved.duration, step); });
}

GrainScene build_grain_scene(const GrainCase& resolved, double step) {
  GrainScene scene = resolved.scene;
  scene.pairs = pairs_at(resolved.contacts, resolved.options.law, step);
  return scene;
}

std::vector<GrainStage> build_grain_stages(const GrainCase& resolved, double step) {
  std::vector<GrainStage> stages;
  if (resolved.stages.empty())
    stages.push_back({.name = "run", .scene = build_grain_scene(resolved, step), .steps = count_steps(resolved, step)});
  for (std::size_t k = 0; k < resolved.stages.size(); ++k) {
    const StageCase& stage = resolved.stages[k];
    GrainStage& made = stages.emplace_back(static_cast<const GrainStage&>(stage));
    made.steps = stage.given_steps ? *stage.given_steps : count_steps(*stage.duration, step);
    made.place = repeated(resolved.document, "stage")[k].where();
    made.scene.pairs = pairs_at(stage.contacts, resolved.options.law, step);
  }
  return stages;
}

GrainOptions grain_options(const GrainCase& resolved, double step) {
  GrainOptions options = resolved.options;
  options.time_step = step;
  return options;
}

}  // namespace equidem
