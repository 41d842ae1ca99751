// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/casefile/build.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "equidem/assembly/delaunay.hpp"
#include "equidem/assembly/files.hpp"
#include "equidem/assembly/lattices.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/material/spring_relations.hpp"

namespace equidem {
namespace {

[[noreturn]] void fail(const std::string& where, const std::string& problem, const std::string& why,
                       const std::string& remedy) {
  throw Error(ErrorKind::bad_input, problem, why, remedy, where);
}

Assembly generate(const AssemblyCase& wanted) {
  switch (wanted.kind) {
    case AssemblyKind::lattice:
      return wanted.arrangement->make(wanted.lattice);
    case AssemblyKind::delaunay:
      return delaunay_assembly(wanted.delaunay);
    case AssemblyKind::file:
      return read_assembly(wanted.path);
  }
  return {};
}

DiscGroup discs_of(const GroupCase& wanted, const Assembly& assembly, const std::string& where) {
  const auto count = static_cast<std::int32_t>(assembly.size());
  DiscGroup result;
  for (const std::int32_t disc : wanted.discs) {
    if (disc >= count) {
      fail(where, fmt::format("group '{}' names disc {}", wanted.name, disc),
           fmt::format("the assembly has {}, numbered from 0", counted(count, "disc")), "Correct the list");
    }
    result.discs.push_back(disc);
  }
  std::sort(result.discs.begin(), result.discs.end());
  result.discs.erase(std::unique(result.discs.begin(), result.discs.end()), result.discs.end());
  if (!wanted.box_low) return result;

  const Vec2 low = *wanted.box_low, high = *wanted.box_high;
  Vec2 least = assembly.centres.front(), most = least;
  for (std::int32_t disc = 0; disc < count; ++disc) {
    const Vec2 x = assembly.centres[static_cast<std::size_t>(disc)];
    least = {std::min(least.x, x.x), std::min(least.y, x.y)};
    most = {std::max(most.x, x.x), std::max(most.y, x.y)};
    if (x.x >= low.x && x.x <= high.x && x.y >= low.y && x.y <= high.y) result.discs.push_back(disc);
  }
  if (result.discs.empty()) {
    fail(where, fmt::format("no disc has its centre in the box of group '{}'", wanted.name),
         fmt::format("the centres lie in [{:.6g}, {:.6g}, {:.6g}, {:.6g}]", least.x, least.y, most.x, most.y),
         "Move or widen the box");
  }
  return result;
}

void add_groups(Assembly& assembly, const Case& resolved) {
  for (std::size_t k = 0; k < resolved.groups.size(); ++k) {
    const GroupCase& wanted = resolved.groups[k];
    const std::string where = resolved.where(fmt::format("group.{}.{}", k, wanted.box_low ? "box" : "discs"));
    if (assembly.groups.contains(wanted.name)) {
      fail(resolved.where(fmt::format("group.{}.name", k)),
           fmt::format("the assembly has a group '{}' of its own", wanted.name), "a name means one group",
           "Choose another name");
    }
    assembly.groups[wanted.name] = discs_of(wanted, assembly, where);
  }
}

/// Whatever acts on a group needs one that exists and holds discs.
void check_group_names(const Assembly& assembly, const Case& resolved) {
  for (const char* table : {"support", "load", "velocity", "probe"}) {
    const TomlValue* list = resolved.document.find(table);
    for (std::size_t k = 0; list != nullptr && k < list->items.size(); ++k) {
      const std::string where = resolved.where(fmt::format("{}.{}.group", table, k));
      const std::string& name = list->items[k].find("group")->text;
      try {
        if (group(assembly, name).discs.empty())
          bad_input(fmt::format("group '{}' holds no disc", name), fmt::format("the {} would do nothing", table),
                    "Choose another group");
      } catch (const Error& error) {
        throw error.at(where);
      }
    }
  }
}

SpringConstants springs_of_material(const Case& resolved, const ChosenRelation& chosen) {
  const MaterialCase& material = *resolved.material;
  const Lattice* lattice = resolved.assembly.arrangement;
  if (resolved.weighting != SpringWeighting::uniform && lattice != nullptr &&
      lattice->relation.equal_springs != nullptr) {
    bad_input(fmt::format("the weighting is \"{}\" on the {}", to_string(resolved.weighting), lattice->relation.place),
              fmt::format("its relation to moduli (Abe 1996, eq. {}) is for equal springs", lattice->relation.equation),
              "Use weighting = \"uniform\"");
  }
  return springs_for(material.moduli, chosen.relation, chosen.measures,
                     material.static_only ? NegativeTangential::static_only : NegativeTangential::refuse);
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

}  // namespace

Assembly build_assembly(const Case& resolved) {
  Assembly assembly;
  try {
    assembly = generate(resolved.assembly);
    if (!resolved.assembly.own_springs) {
      assembly.contact_kN.clear();
      assembly.contact_kT.clear();
    }
  } catch (const Error& error) {
    throw error.at(resolved.where(resolved.assembly.kind == AssemblyKind::file ? "assembly.path" : "assembly"));
  }
  add_groups(assembly, resolved);
  check_group_names(assembly, resolved);
  check(assembly);
  return assembly;
}

std::optional<double> disc_density(const Case& resolved, const Assembly& assembly) {
  const std::optional<double>& rho = resolved.assembly.density;
  if (!resolved.material || !resolved.material->density) return rho;
  const double gamma = *resolved.material->density;
  const std::string where = resolved.where("material.density");
  if (resolved.assembly.body == Body::sphere) {
    if (rho) return rho;
    fail(where, "the density of a continuum does not give that of spheres",
         "a sheet of spheres has no mass per metre of depth", "Give assembly.density");
  }
  const double phi = assembly.solid_fraction();
  if (!rho) return gamma / phi;
  constexpr double tolerance = 1e-6;
  if (std::abs(gamma - *rho * phi) <= tolerance * gamma) return rho;
  fail(where, fmt::format("density = {:.9g} kg/m³ contradicts the density of the discs", gamma),
       fmt::format("discs of {:.9g} kg/m³ that fill {:.6g} of the area make {:.9g} kg/m³", *rho, phi, *rho * phi),
       "Remove one of the two");
}

ChosenRelation spring_relation(const Case& resolved, const Assembly& assembly) {
  if (resolved.weighting == SpringWeighting::uniform) {
    if (resolved.assembly.arrangement != nullptr) return {resolved.assembly.arrangement->relation, {}};
  }
  switch (resolved.weighting) {
    case SpringWeighting::contact_density:
      return {isotropic_relation, {assembly.solid_fraction(), 1.0}};
    case SpringWeighting::voronoi:
      return {isotropic_relation, {0.5, 1.0}};
    case SpringWeighting::uniform:
      break;
  }
  const double psi = assembly.coordination_number() / (2 * std::numbers::pi);
  return {isotropic_relation, {assembly.solid_fraction(), psi}};
}

BuiltSprings build_springs(const Case& resolved, const Assembly& assembly) {
  const bool own = !assembly.contact_kN.empty();
  if (!resolved.springs && !resolved.material && !own) {
    if (assembly.contacts.empty()) {
      fail(resolved.where("assembly.path"), "the assembly has no contacts", "nothing resists its deformation",
           "Give it contacts");
    }
    fail(resolved.where("assembly.path"), "the springs are missing",
         resolved.assembly.own_springs
             ? "neither the case file nor the assembly file gives any"
             : "the case file gives none, and says that those of the assembly file do not count",
         "Add [springs] with kN and kT to the case file");
  }
  const std::string where = resolved.where(resolved.material ? "material" : "springs");
  try {
    if (own) {
      return {contact_springs(assembly, resolved.springs.value_or(SpringConstants{}), resolved.weighting),
              {},
              resolved.springs || resolved.material
                  ? "springs of the assembly file; those of the case file are not used (own_springs = false: they are)"
                  : "springs of the assembly file"};
    }
    SpringConstants constants;
    std::string report;
    if (resolved.material) {
      const ChosenRelation chosen = spring_relation(resolved, assembly);
      constants = springs_of_material(resolved, chosen);
      report = described(*resolved.material, constants, resolved.weighting, chosen.relation);
    } else {
      constants = *resolved.springs;
      report = described(constants, resolved.weighting);
    }
    return {contact_springs(assembly, constants, resolved.weighting), constants, report};
  } catch (const Error& error) {
    throw error.at(where);
  }
}

}  // namespace equidem
