// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/casefile/assembly/build.hpp"

#include <algorithm>
#include <cassert>
#include <set>

#include "equidem/assembly/delaunay.hpp"
#include "equidem/assembly/files.hpp"
#include "equidem/assembly/lattices.hpp"
#include "equidem/assembly/touching.hpp"
#include "equidem/casefile/engine/bind.hpp"
#include "equidem/casefile/motion_case.hpp"
#include "equidem/contact/contact_springs.hpp"
#include "equidem/contact/materials.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/dynamics/scene_check.hpp"
#include "equidem/homogenize/tension_test.hpp"
#include "equidem/packing/measures.hpp"

namespace equidem {
namespace {

using namespace casefile;

Assembly generate(const Case& resolved) {
  const AssemblyCase& wanted = resolved.assembly;
  switch (wanted.kind) {
    case AssemblyKind::lattice:
      return wanted.arrangement->make(wanted.lattice);
    case AssemblyKind::delaunay:
      return delaunay_assembly(wanted.delaunay);
    case AssemblyKind::packing: {
      const GrainPacking packing = at_key(
          *resolved.document.find("packing"), [&] { return pack(*wanted.packing); }, "method");
      Assembly assembly = network_of(packing, {.gap_tolerance = wanted.gap_tolerance});
      if (!assembly.contacts.empty()) measure_cells(assembly);
      return assembly;
    }
    case AssemblyKind::file:
      return read_assembly(wanted.path, wanted.file);
  }
  return {};
}

DiscGroup discs_of(const GroupCase& wanted, const Assembly& assembly, const std::string& where) {
  if (wanted.box) return with_place(where, [&] { return discs_in(assembly, *wanted.box); });
  DiscGroup result{wanted.discs, {}};
  std::ranges::sort(result.discs);
  result.discs.erase(std::unique(result.discs.begin(), result.discs.end()), result.discs.end());
  if (const std::int32_t last = result.discs.back(); static_cast<std::size_t>(last) >= assembly.size())
    bad_input_at(where, fmt::format("group '{}' names disc {}", wanted.name, last),
                 fmt::format("the assembly has {}, numbered from 0", counted(std::ssize(assembly.centres), "disc")),
                 "Correct the list");
  return result;
}

void add_groups(Assembly& assembly, const Case& resolved) {
  std::vector<GroupShare> shares;
  GroupDraw draw;
  for (std::size_t k = 0; k < resolved.groups.size(); ++k) {
    const GroupCase& wanted = resolved.groups[k];
    if (assembly.groups.contains(wanted.name))
      bad_input_at(resolved.where(fmt::format("group.{}.name", k)),
                   fmt::format("the assembly has a group '{}' of its own", wanted.name), "a name means one group",
                   "Choose another name");
    if (wanted.share) {
      shares.push_back({wanted.name, *wanted.share});
      draw = wanted.draw;
      continue;
    }
    const std::string where = resolved.where(fmt::format("group.{}.{}", k, wanted.box ? "box" : "discs"));
    assembly.groups[wanted.name] = discs_of(wanted, assembly, where);
  }
  if (!shares.empty()) with_place(resolved.where("group"), [&] { draw_groups(assembly, shares, draw); });
}

/// Tables that act on a group need an existing group that contains discs.
void check_group_names(const Assembly& assembly, const Case& resolved) {
  for (const char* table : {"support", "load", "velocity", "probe"}) {
    const std::vector<TomlValue>& list = repeated(resolved.document, table);
    for (std::size_t k = 0; k < list.size(); ++k) {
      const TomlValue* name = list[k].find("group");
      if (name == nullptr) continue;
      with_place(resolved.where(fmt::format("{}.{}.group", table, k)), [&] {
        if (group(assembly, name->text).discs.empty())
          bad_input(fmt::format("group '{}' holds no disc", name->text), fmt::format("the {} would do nothing", table),
                    "Choose another group");
      });
    }
  }
}

std::string described(const SpringConstants& springs, SpringWeighting weighting) {
  return fmt::format("kN = {:.6g} Pa, kT = {:.6g} Pa (kT/kN = {:.6g}), weighting {}", springs.kN, springs.kT,
                     springs.ratio(), to_string(weighting));
}

std::string described(const MaterialCase& material, const SpringConstants& springs, SpringWeighting weighting,
                      const SpringRelation& relation) {
  return fmt::format("G = {:.6g} Pa, nu = {:.6g} (plane {}) gives {}. The relation {}", material.moduli.shear_modulus,
                     material.moduli.poisson_ratio, to_string(material.moduli.plane), described(springs, weighting),
                     relation.validity);
}

/// "; quartz: 120 discs; quartz, quartz: kN = 1e+09 Pa, kT = 5e+08 Pa at 312 contacts"
std::string described(const std::vector<OfPair<SpringConstants>>& between, const Assembly& assembly,
                      const Materials& materials) {
  std::vector<std::int64_t> counts(between.size(), 0);
  for (std::size_t c = 0; c < assembly.contacts.size(); ++c)
    if (const auto pair = materials.pair_of(c)) ++counts[*pair];
  std::set<std::string> names;
  for (const auto& pair : between) names.insert(pair.groups.begin(), pair.groups.end());
  std::string text;
  for (const std::string& name : names)
    text += fmt::format("; {}: {}", name, counted(std::ssize(group(assembly, name).discs), "disc"));
  for (std::size_t k = 0; k < between.size(); ++k)
    text += fmt::format("; {}: kN = {:.6g} Pa, kT = {:.6g} Pa at {}", name_of(between[k]), between[k].property.kN,
                        between[k].property.kT, counted(counts[k], "contact"));
  return text;
}

/// The springs of the case at each contact: those of the two groups of its discs, weighted.
ContactSprings springs_between(const Case& resolved, const Assembly& assembly, const Materials& materials) {
  std::vector<SpringConstants> springs = materials.of_contacts(*resolved.springs, resolved.springs_between, in_series);
  const ContactSprings weights = contact_springs(assembly, {1, 1}, resolved.weighting);
  for (std::size_t c = 0; c < springs.size(); ++c) {
    const double weight = weights[c].kN;
    springs[c] = {weight * springs[c].kN, weight * springs[c].kT};
  }
  return ContactSprings(std::move(springs));
}

}  // namespace

void add_constant_actions(Scene& scene, std::span<const Support> supports, const LoadCase& loads) {
  const auto constant = [](const std::optional<double>& value) -> std::optional<Schedule> {
    if (!value) return {};
    return Schedule{.value = *value};
  };
  for (const Support& support : supports)
    scene.supports.push_back({support.group, constant(support.ux), constant(support.uy), constant(support.rotation)});
  for (const Load& load : loads) scene.loads.push_back({.load = load, .factor = {.value = 1}});
}

Assembly build_assembly(const Case& resolved) {
  const AssemblyCase& wanted = resolved.assembly;
  const bool packed = wanted.kind == AssemblyKind::packing;
  const char* source = wanted.kind == AssemblyKind::file ? "assembly.path" : "assembly";
  Assembly assembly = with_place(resolved.where(source), [&] { return generate(resolved); });
  with_place(resolved.where(packed ? "packing.gap_tolerance" : "assembly.gap_tolerance"),
             [&] { check_found_contacts(assembly); });
  if (wanted.levers)
    with_place(resolved.where("assembly.levers"), [&] { place_contact_points(assembly, *wanted.levers); });
  if (!wanted.own_springs) {
    assembly.contact_kN.clear();
    assembly.contact_kT.clear();
  }
  add_groups(assembly, resolved);
  check_group_names(assembly, resolved);
  check(assembly);
  return assembly;
}

std::optional<double> disc_density(const Case& resolved, const Assembly& assembly) {
  return with_place(resolved.where("material.density"), [&] {
    return disc_density(resolved.assembly.density, resolved.material ? resolved.material->given.density : std::nullopt,
                        resolved.assembly.body, assembly);
  });
}

ChosenRelation spring_relation(const Case& resolved, const Assembly& assembly) {
  return spring_relation(assembly, resolved.weighting, resolved.assembly.arrangement);
}

BuiltSprings build_springs(const Case& resolved, const Assembly& assembly) {
  const bool own = !assembly.contact_kN.empty();
  if (!resolved.springs && !resolved.material && !own) {
    if (assembly.contacts.empty()) {
      bad_input_at(resolved.where("assembly.path"), "the assembly has no contacts", "nothing resists its deformation",
                   "Give it contacts");
    }
    bad_input_at(resolved.where("springs"), "the springs are missing",
                 resolved.assembly.own_springs
                     ? "neither the case nor the assembly gives any"
                     : "the case gives none, and own_springs = false leaves out those of the assembly",
                 "Give springs with kN and kT");
  }
  if (own && (resolved.springs || resolved.material)) {
    bad_input_at(resolved.where(resolved.springs ? "springs" : "material"),
                 "the case gives springs, and so does the assembly file", "one of the two would not count",
                 "Remove those of the case, or set assembly.own_springs = false to take them");
  }
  const auto built = [&]() -> BuiltSprings {
    if (own) return {contact_springs(assembly, {}, resolved.weighting), {}, "springs of the assembly file"};
    if (!resolved.springs_between.empty()) {
      const Materials materials(assembly, resolved.springs_between);
      return {
          springs_between(resolved, assembly, materials),
          {},
          described(*resolved.springs, resolved.weighting) + described(resolved.springs_between, assembly, materials)};
    }
    if (!resolved.material) {
      return {contact_springs(assembly, *resolved.springs, resolved.weighting), *resolved.springs,
              described(*resolved.springs, resolved.weighting)};
    }
    const MaterialCase& material = *resolved.material;
    const SpringConstants constants =
        springs_of_moduli(material.moduli, assembly, resolved.weighting, resolved.assembly.arrangement,
                          material.static_only ? NegativeTangential::static_only : NegativeTangential::refuse);
    return {contact_springs(assembly, constants, resolved.weighting), constants,
            described(material, constants, resolved.weighting, spring_relation(resolved, assembly).relation)};
  };
  const char* table = resolved.material ? "material" : resolved.springs_between.empty() ? "springs" : "springs.between";
  return with_place(resolved.where(table), [&] {
    BuiltSprings result = built();
    result.springs = bending_springs(assembly, result.springs, resolved.bending);
    if (resolved.bending.kM) result.report += fmt::format(", kM = {:.6g} N", *resolved.bending.kM);
    if (resolved.bending.bond_width)
      result.report += fmt::format(", bonds {:.6g} times as wide as the smaller disc", *resolved.bending.bond_width);
    return result;
  });
}

Scene build_scene(const Case& resolved, const Assembly& assembly, const ContactSprings& springs) {
  if (!resolved.run) {
    bad_input_at(fmt::format("{}: run", resolved.document.where()), "missing table", "it says how long the run is",
                 "Add [run] with duration = ... in s, or until_rest = 1e-10");
  }
  const std::optional<double> density = disc_density(resolved, assembly);
  if (!density) {
    bad_input_at(resolved.where("assembly"), "the density is missing", "motion needs the mass of the discs",
                 "Add density = ... in kg/m³ to [assembly], or that of the continuum to [material]");
  }
  const RunCase& run = *resolved.run;
  Scene scene(assembly, springs, inertia_of(assembly, *density, resolved.assembly.body));
  scene.supports = run.supports;
  scene.loads = run.loads;
  scene.velocities = run.velocities;
  scene.walls = run.walls;
  scene.gravity = run.gravity;
  if (resolved.test) {
    const TensionSetup test =
        with_place(resolved.where("test"), [&] { return tension_setup(assembly, *resolved.test); });
    add_constant_actions(scene, test.supports, test.loads);
  }
  check(scene, resolved.rotation, [&](const std::string& path) { return resolved.where(path); });
  return scene;
}

std::vector<Probe> build_probes(const Case& resolved, const Assembly& assembly) {
  std::vector<Probe> probes = resolved.run->probes;
  for (std::size_t k = 0; k < probes.size(); ++k) {
    check_bodies(repeated(resolved.document, "probe")[k], probes[k], assembly.size());
    if (probes[k].bodies.empty()) probes[k].bodies = group(assembly, probes[k].group).discs;
  }
  return probes;
}

SimulationOptions simulation_options(const Case& resolved, double time_step) {
  assert(resolved.run && time_step > 0);
  const RunCase& run = *resolved.run;
  Damping damping = run.damping;
  if (resolved.viscoelastic) {
    const Viscoelasticity& springs = resolved.viscoelastic->springs;  // check_viscoelastic admits Kelvin-Voigt alone
    damping.normal_time = springs.normal.time;
    damping.tangential_time = springs.tangential.time;
  }
  return {.motion = run.motion,
          .integrator = run.integrator,
          .rotation = resolved.rotation,
          .damping = damping,
          .time_step = time_step};
}

}  // namespace equidem
