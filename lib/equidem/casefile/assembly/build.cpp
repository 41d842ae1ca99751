// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/casefile/assembly/build.hpp"

#include <algorithm>

#include "equidem/assembly/delaunay.hpp"
#include "equidem/assembly/files.hpp"
#include "equidem/assembly/lattices.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

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
      bad_input_at(where, fmt::format("group '{}' names disc {}", wanted.name, disc),
                   fmt::format("the assembly has {}, numbered from 0", counted(count, "disc")), "Correct the list");
    }
    result.discs.push_back(disc);
  }
  std::sort(result.discs.begin(), result.discs.end());
  result.discs.erase(std::unique(result.discs.begin(), result.discs.end()), result.discs.end());
  if (!wanted.box) return result;

  const auto [low, high] = *wanted.box;
  Vec2 least = assembly.centres.front(), most = least;
  for (std::int32_t disc = 0; disc < count; ++disc) {
    const Vec2 x = assembly.centres[static_cast<std::size_t>(disc)];
    least = {std::min(least.x, x.x), std::min(least.y, x.y)};
    most = {std::max(most.x, x.x), std::max(most.y, x.y)};
    if (x.x >= low.x && x.x <= high.x && x.y >= low.y && x.y <= high.y) result.discs.push_back(disc);
  }
  if (result.discs.empty()) {
    bad_input_at(where, fmt::format("no disc has its centre in the box of group '{}'", wanted.name),
                 fmt::format("the centres lie in [{:.6g}, {:.6g}, {:.6g}, {:.6g}]", least.x, least.y, most.x, most.y),
                 "Move or widen the box");
  }
  return result;
}

void add_groups(Assembly& assembly, const Case& resolved) {
  for (std::size_t k = 0; k < resolved.groups.size(); ++k) {
    const GroupCase& wanted = resolved.groups[k];
    const std::string where = resolved.where(fmt::format("group.{}.{}", k, wanted.box ? "box" : "discs"));
    if (assembly.groups.contains(wanted.name)) {
      bad_input_at(resolved.where(fmt::format("group.{}.name", k)),
                   fmt::format("the assembly has a group '{}' of its own", wanted.name), "a name means one group",
                   "Choose another name");
    }
    assembly.groups[wanted.name] = discs_of(wanted, assembly, where);
  }
}

/// Tables that act on a group need an existing group that contains discs.
void check_group_names(const Assembly& assembly, const Case& resolved) {
  for (const char* table : {"support", "load", "velocity", "probe"}) {
    const TomlValue* list = resolved.document.find(table);
    for (std::size_t k = 0; list != nullptr && k < list->items.size(); ++k) {
      if (list->items[k].find("group") == nullptr) continue;
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
  try {
    return disc_density(resolved.assembly.density, resolved.material ? resolved.material->density : std::nullopt,
                        resolved.assembly.body, assembly);
  } catch (const Error& error) {
    throw error.at(resolved.where("material.density"));
  }
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
    bad_input_at(resolved.where("assembly.path"), "the springs are missing",
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
  } catch (const Error& error) {
    throw error.at(where);
  }
}

}  // namespace equidem
