// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>
#include <utility>

#include "equidem/casefile/engine/read_value.hpp"
#include "equidem/casefile/grains/grain_tables.hpp"
#include "equidem/core/table_file.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

namespace fs = std::filesystem;
using casefile::fail_at;
using casefile::repeated;

struct Strength {
  const char* key;
  double GrainBond::*value;
  const char* unit;
  const char* help;
};
constexpr Strength strengths[] = {
    {"normal_dashpot", &GrainBond::normal_dashpot, "N s/m (discs: per m of depth)",
     "C_n along the line of centres: a pair stops as exp(-C_n t/m), m the reduced mass; a steady pull N makes it creep "
     "at N/C_n"},
    {"tangential_dashpot", &GrainBond::tangential_dashpot, "N s/m (discs: per m of depth)",
     "C_s across it, at the point of the bond; no friction limits it"},
    {"rolling_dashpot", &GrainBond::rolling_dashpot, "N m s",
     "against the relative spin; 0 in the thesis: discs roll freely on one another"},
    {"normal_spring", &GrainBond::normal_spring, "N/m (discs: per m of depth)",
     "back to the distance at the start; 0 in the thesis: bonds creep"},
    {"tangential_spring", &GrainBond::tangential_spring, "N/m (discs: per m of depth)", "the same across"},
};

/// Bonds with the place of each in the user's input.
struct PlacedBonds {
  std::vector<GrainBond> bonds;
  std::vector<std::string> places;
};

std::size_t grain_number(std::string_view cell, const TableFile& file) {
  const auto number = number_from<std::size_t>(cell);
  if (!number)
    file.fail(fmt::format("'{}' is no number of a grain", cell), "grains are counted 0, 1, 2, ...", "Correct it");
  return *number;
}

/// Rows "i,j,..." under a row of names; columns that are named like a strength say how, others are passed over.
void read_file_of_bonds(const fs::path& path, const GrainBond& common, PlacedBonds& result) {
  TableFile file(path);
  if (!file.next()) return;
  const std::vector<std::string> names(file.cells().begin(), file.cells().end());
  if (names.size() < 2 || names[0] != "i" || names[1] != "j")
    file.fail("the first two columns are not i and j", "they say which grains are tied", "Begin the file with i,j");
  while (file.next()) {
    const auto& cells = file.cells();
    GrainBond bond = common;
    bond.i = grain_number(cells[0], file);
    bond.j = grain_number(cells.size() > 1 ? cells[1] : "", file);
    for (std::size_t c = 2; c < std::min(cells.size(), names.size()); ++c) {
      const auto strength = std::ranges::find(strengths, names[c], &Strength::key);
      if (strength == std::end(strengths) || cells[c].empty()) continue;
      const auto value = number_from<double>(cells[c]);
      if (!value || !std::isfinite(*value) || *value < 0)
        file.fail(fmt::format("'{}' is no {}", cells[c], strength->key), "a number >= 0 is needed", "Correct it");
      bond.*strength->value = *value;
    }
    result.bonds.push_back(bond);
    result.places.push_back(file.where());
  }
}

}  // namespace

std::vector<casefile::Key<GrainBond>> casefile::bond_keys(bool base) {
  std::vector<Key<GrainBond>> keys;
  for (const Strength& strength : strengths)
    keys.push_back(key(strength.key, strength.value, optional, unit(strength.unit), not_negative,
                       base ? strength.help : "instead of that of [bonds]"));
  return keys;
}

void casefile::bind_bonds(File<GrainTables>& file) {
  file.table("bonds", &GrainTables::bonds, "properties of all bonds")
      .keys({key("path", &BondsTable::path,
                 "a CSV file whose first two columns i, j number the grains that are tied; columns named like the keys "
                 "below say how, instead of these; bonds.csv of run and pack can be read back")});
  file.table("bonds").keys({key_in<GrainTables>(
      "step", &GrainCase::options, &GrainOptions::bond_step, optional,
      "exact (default): each bond decays as it should in whatever step; explicit: dashpots by the velocities at the "
      "start of the step, as in Sukegawa (2010), with the limit dt < 2 m/C_n, 2 m/(3 C_s) of equal discs")});
  file.table("bonds", &GrainTables::bonds, &BondsTable::common).keys(bond_keys(true));
  std::vector<Key<GrainBond>> keys{
      unbound_key<GrainBond>("grains", KeyType::discs, required,
                             "[i, j]: two discs, counted from 0, those of the file first; they do not collide")};
  for (Key<GrainBond>& key : bond_keys(false)) keys.push_back(std::move(key));
  file.table("bond", repeated_table, "two discs tied by dashpots").described(std::move(keys));
}

void casefile::read_bonds(const TomlValue& root, GrainTables& tables) {
  static const auto keys = casefile::bond_keys(false);
  PlacedBonds read;
  if (const TomlValue* table = root.find("bonds")) {
    if (tables.bonds.path) {
      try {
        read_file_of_bonds(*tables.bonds.path, tables.bonds.common, read);
      } catch (const Error& error) {
        throw error.at(fmt::format("{}: bonds.path", table->find("path")->where()));
      }
    } else if (repeated(root, "bond").empty()) {
      fail_at(*table, "bonds", "no grains are tied", "the table only says how", "Add [[bond]] with grains, or a path");
    }
  }
  for (const TomlValue& table : repeated(root, "bond")) {
    const TomlValue& two = *table.find("grains");
    if (two.items.size() != 2)
      fail_at(two, "bond.grains",
              fmt::format("{} are {}", two.shown(), counted(static_cast<long long>(two.items.size()), "grain")),
              "a bond ties two", "Write it like grains = [0, 1]");
    GrainBond& bond = read.bonds.emplace_back(tables.bonds.common);
    TomlValue copy = table;
    casefile::read_table(keys, copy, {}, bond);
    bond.i = static_cast<std::size_t>(two.items[0].integer);
    bond.j = static_cast<std::size_t>(two.items[1].integer);
    read.places.push_back(fmt::format("{}: bond", table.where()));
  }
  tables.scene.bonds = std::move(read.bonds);
  check_bonds(tables.scene, [&](std::size_t bond) { return read.places[bond]; });
}

}  // namespace equidem
