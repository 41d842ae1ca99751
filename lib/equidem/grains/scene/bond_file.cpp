// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/grains/scene/bond_file.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "equidem/core/names.hpp"
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

/// Columns that a run writes and this reader passes over.
constexpr std::array others = {"distance_drift", "slip_drift", "roll"};

std::size_t grain_number(std::size_t column, const TableFile& file) {
  const auto number = number_from<std::size_t>(file.cells()[column]);
  if (!number)
    file.fail(fmt::format("'{}' is no number of a grain", file.cells()[column]), "grains are counted 0, 1, 2, ...",
              "Correct it");
  return *number;
}

/// A name that is nearly one of those that are read is taken for a typing error: its bonds would never break.
void refuse_near_names(const TableFile& file) {
  std::vector<std::string> known = names_in(properties_of_bonds);
  known.insert(known.end(), {"tension", "shear"});
  for (const ColumnName& column : file.names()) {
    const auto is_name = [&](const std::string& name) { return column.name == name; };
    if (std::ranges::any_of(others, is_name) || column.name.size() < 4) continue;
    const auto with_unit = std::ranges::find_if(known, [&](const std::string& name) {
      return column.name.starts_with(name + "_") || (column.name == name && !column.unit.empty());
    });
    if (with_unit != known.end())
      file.fail_at_names(fmt::format("the column '{}' is in a unit of its own", column.text),
                         "springs and strengths are in N/m, dashpots in N s/m",
                         fmt::format("Convert it, and name it '{}'", *with_unit));
    if (std::ranges::any_of(known, is_name)) continue;
    if (const auto meant = nearest(column.name, known))
      file.fail_at_names(fmt::format("there is no column '{}' of bonds", column.text), "it is nearly one that is read",
                         fmt::format("Did you mean '{}'?", *meant));
  }
}

}  // namespace

std::span<const BondProperty> bond_properties() {
  return properties_of_bonds;
}

BondRows read_bonds(const std::filesystem::path& path, const GrainBond& common) {
  struct Column {
    std::size_t place;
    std::string_view name;
    double GrainBond::*property;
    std::optional<double> BondRows::Strength::*strength;
  };
  BondRows result;
  TableFile file(path, {{"i"}, {"j"}});
  if (file.width() == 0) return result;
  const auto i = file.find({"i"}), j = file.find({"j"});
  if (!i || !j)
    file.fail_at_names("there are no columns i and j", "they say which grains are tied", "Begin the file with i,j");
  refuse_near_names(file);
  std::vector<Column> columns;
  for (const BondProperty& property : properties_of_bonds)
    if (const auto place = file.find({property.name}))
      columns.push_back({*place, property.name, property.value, nullptr});
  if (const auto place = file.find({"tension"}))
    columns.push_back({*place, "tension", nullptr, &BondRows::Strength::tension});
  if (const auto place = file.find({"shear"}))
    columns.push_back({*place, "shear", nullptr, &BondRows::Strength::shear});
  while (file.next()) {
    GrainBond bond = common;
    BondRows::Strength own;
    bond.i = grain_number(*i, file);
    bond.j = grain_number(*j, file);
    for (const Column& column : columns) {
      if (file.cells()[column.place].empty()) continue;
      const double value = file.number(column.place, column.name);
      if (value < 0)
        file.fail(fmt::format("'{}' is no {}", file.cells()[column.place], column.name), "a number >= 0 is needed",
                  "Correct it");
      if (column.strength != nullptr)
        own.*column.strength = value;
      else
        bond.*column.property = value;
    }
    result.strengths.push_back(own);
    result.bonds.push_back(bond);
    result.places.push_back(file.where());
  }
  return result;
}

}  // namespace equidem
