// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/grains/scene/bond_file.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string_view>

#include "equidem/core/table_file.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

constexpr BondProperty properties_of_bonds[] = {
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
    {"bending_spring", &GrainBond::bending_spring, "N m (discs: per m of depth)",
     "kM, moment by the rotation of one disc against the other; a parallel bond of width w has normal_spring w²/12"},
};

std::size_t grain_number(std::string_view cell, const TableFile& file) {
  const auto number = number_from<std::size_t>(cell);
  if (!number)
    file.fail(fmt::format("'{}' is no number of a grain", cell), "grains are counted 0, 1, 2, ...", "Correct it");
  return *number;
}

}  // namespace

std::span<const BondProperty> bond_properties() {
  return properties_of_bonds;
}

BondRows read_bonds(const std::filesystem::path& path, const GrainBond& common) {
  BondRows result;
  TableFile file(path);
  if (!file.next()) return result;
  const std::vector<std::string> names(file.cells().begin(), file.cells().end());
  if (names.size() < 2 || names[0] != "i" || names[1] != "j")
    file.fail("the first two columns are not i and j", "they say which grains are tied", "Begin the file with i,j");
  while (file.next()) {
    const auto& cells = file.cells();
    GrainBond bond = common;
    BondRows::Strength own;
    bond.i = grain_number(cells[0], file);
    bond.j = grain_number(cells.size() > 1 ? cells[1] : "", file);
    for (std::size_t c = 2; c < std::min(cells.size(), names.size()); ++c) {
      const auto property = std::ranges::find(properties_of_bonds, names[c], &BondProperty::name);
      const bool strength = names[c] == "tension" || names[c] == "shear";
      if ((property == std::end(properties_of_bonds) && !strength) || cells[c].empty()) continue;
      const auto value = number_from<double>(cells[c]);
      if (!value || !std::isfinite(*value) || *value < 0)
        file.fail(fmt::format("'{}' is no {}", cells[c], names[c]), "a number >= 0 is needed", "Correct it");
      if (strength)
        (names[c] == "tension" ? own.tension : own.shear) = *value;
      else
        bond.*property->value = *value;
    }
    result.strengths.push_back(own);
    result.bonds.push_back(bond);
    result.places.push_back(file.where());
  }
  return result;
}

}  // namespace equidem
