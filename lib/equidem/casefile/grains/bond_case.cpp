// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// [bonds] and [[bond]].
#include <algorithm>

#include "equidem/casefile/assembly/strength_tables.hpp"
#include "equidem/casefile/engine/value.hpp"
#include "equidem/casefile/grains/grain_tables.hpp"
#include "equidem/grains/contacts/bond_breaking.hpp"
#include "equidem/grains/scene/grain_file.hpp"

namespace equidem::casefile {
namespace {

/// The dashpots and springs of a bond. In [bonds] they have help, elsewhere they override those.
std::vector<Key<GrainBond>> keys_of_bonds(bool base) {
  std::vector<Key<GrainBond>> keys;
  for (const BondProperty& property : bond_properties())
    keys.push_back(key(property.name, property.value, optional, unit(property.unit), not_negative,
                       base ? property.help : "instead of that of [bonds]"));
  return keys;
}

/// Of those of contacts that break at rest: without a bond discs always rub, and have no facets.
std::vector<Key<StrengthOptions>> strength_keys_of_bonds() {
  std::vector<Key<StrengthOptions>> keys = strength_keys();
  std::erase_if(keys, [](const Key<StrengthOptions>& key) {
    return key.spec.name == "after_breaking" || key.spec.name == "residual_friction";
  });
  for (Key<StrengthOptions>& key : keys) {
    if (key.spec.name == "bond_length") {
      key.spec.choices = {"none", "smaller_diameter"};
      key.spec.help =
          "the length by which strengths in Pa are multiplied: the diameter of the smaller disc; none: strengths are "
          "forces";
    }
    if (key.spec.name == "tension")
      key.spec.help = "a bond breaks where its normal force, and what its moment adds at the outer fibre, reach it";
  }
  return keys;
}

}  // namespace

void bind_bonds(File<GrainTables>& file) {
  file.table("bonds", &GrainTables::bonds, "properties of all bonds")
      .keys({key("path", &BondsTable::path,
                 "a CSV file whose first two columns i, j number the grains that are tied; columns named like the keys "
                 "below say how, instead of these; bonds.csv of run and pack can be read back")});
  file.table("bonds").keys({key_in<GrainTables>(
      "step", &GrainCase::options, &GrainOptions::bond_step, optional,
      "exact (default): each bond decays as it should in whatever step, bonds that share discs in short steps alone, "
      "where they decay one after the other, by the places of the discs: a mirror image differs by the square of the "
      "step; explicit: dashpots by the velocities at the start of the step, as in Sukegawa (2010), with the limit "
      "dt < 2 m/C_n, 2 m/(3 C_s) of equal discs: right for chains of discs with strong dashpots")});
  file.table("bonds", &GrainTables::bonds, &BondsTable::common).keys(keys_of_bonds(true));
  std::vector<Key<GrainBond>> keys{
      unbound_key<GrainBond>("grains", KeyType::discs, required,
                             "[i, j]: two discs, counted from 0, those of the file first; they do not collide")};
  for (Key<GrainBond>& key : keys_of_bonds(false)) keys.push_back(std::move(key));
  file.table("bond", repeated_table, "two bonded discs").described(std::move(keys));
  bind_strength_file(file);
  file.table("strength", &GrainTables::strength, "strengths of the bonds; left out: they never break")
      .keys(strength_keys_of_bonds());
}

void resolve_bond_strengths(TomlValue& root, const std::filesystem::path& folder) {
  resolve_strength_file(root, folder, strength_keys_of_bonds());
}

std::vector<Key<StageBonds>> stage_bond_keys() {
  std::vector<Key<StageBonds>> keys{key("gap_tolerance", &StageBonds::gap_tolerance, from(0, 1),
                                        "discs are bonded where the gap between them is at most this share of the sum "
                                        "of their radii; 0: where they touch. Discs that press each other keep their "
                                        "force; those that have or had a bond get no other")};
  for (const BondProperty& property : bond_properties())
    keys.push_back(key(property.name, &StageBonds::like, property.value, optional, unit(property.unit), not_negative,
                       "instead of that of [bonds]"));
  return keys;
}

StageBonds read_stage_bonds(const TomlValue& table, const GrainTables& tables, std::size_t stage) {
  StageBonds bonds{.like = tables.bonds.common, .strengths = tables.strength};
  read_table(stage_bond_keys(), table, bonds);
  const GrainBond& like = bonds.like;
  if (!like.has_springs() && like.normal_dashpot == 0 && like.tangential_dashpot == 0 && like.rolling_dashpot == 0)
    fail_at(table, "stage.bonds", "the bonds have neither dashpots nor springs", "they would tie nothing",
            "Give normal_spring or normal_dashpot here or in [bonds]");
  if (bonds.strengths) bonds.strengths->seed += stage + 1;  // the bonds of the start take the seed itself
  return bonds;
}

void complete_bonds(const TomlValue& root, GrainTables& tables) {
  static const auto keys = keys_of_bonds(false);
  const bool bonds_later = std::ranges::any_of(repeated(root, "stage"),
                                               [](const TomlValue& stage) { return stage.find("bonds") != nullptr; });
  BondRows read;
  if (const TomlValue* table = root.find("bonds")) {
    const auto& path = tables.bonds.path;
    if (path)
      read = with_key(*table, "bonds", "path", [&] { return read_bonds(*path, tables.bonds.common); });
    else if (repeated(root, "bond").empty() && !bonds_later)
      fail_at(*table, "bonds", "no grains are tied", "the table only says how",
              "Add [[bond]] with grains, a path, or [stage.bonds]");
  }
  for (const TomlValue& table : repeated(root, "bond")) {
    const TomlValue& two = *table.find("grains");
    if (two.items.size() != 2)
      fail_at(two, "bond.grains",
              fmt::format("{} are {}", two.shown(), counted(static_cast<long long>(two.items.size()), "grain")),
              "a bond ties two", "Write it like grains = [0, 1]");
    GrainBond& bond = read.bonds.emplace_back(tables.bonds.common);
    read_table(keys, table, bond);
    bond.i = static_cast<std::size_t>(two.items[0].integer);
    bond.j = static_cast<std::size_t>(two.items[1].integer);
    read.places.push_back(fmt::format("{}: bond", table.where()));
  }
  tables.scene.bonds = std::move(read.bonds);
  const auto place = [&](std::size_t bond) { return read.places[bond]; };
  check_bonds(tables.scene, place);  // before their grains are looked up
  if (tables.strength) {
    const TomlValue& table = *root.find("strength");
    if (tables.scene.bonds.empty() && !bonds_later)
      fail_at(table, "strength", "no grains are tied", "there is nothing that could break", "Add [bonds], or [[bond]]");
    if (tables.body == Body::sphere)
      fail_at(table, "strength", "the grains are spheres", "strengths are those of discs, N per metre of depth",
              "Take the table out, or set grains.body = \"disc\"");
    tables.scene.strengths = at_key(table, "strength", [&] { return bond_strengths(tables.scene, *tables.strength); });
    for (std::size_t b = 0; b < read.strengths.size(); ++b) {
      if (const auto& own = read.strengths[b].tension) tables.scene.strengths->tension[b] = *own;
      if (const auto& own = read.strengths[b].shear) tables.scene.strengths->shear[b] = *own;
    }
  } else if (std::ranges::any_of(read.strengths, &BondRows::Strength::given)) {
    fail_at(*root.find("bonds"), "bonds.path", "the file gives strengths, and the case has no [strength]",
            "bonds without that table never break", "Add [strength], or take the columns tension and shear out");
  }
  check_bonds(tables.scene, place);
}

}  // namespace equidem::casefile
