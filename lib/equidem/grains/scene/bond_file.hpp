// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Properties of bonds by name, and bonds of a CSV file, such as bonds.csv of a run or of a packing.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "equidem/grains/scene/grain_scene.hpp"

namespace equidem {

/// A dashpot or spring of a bond.
struct BondProperty {
  const char* name;
  double GrainBond::*value;
  const char* unit;
  const char* help;
};
std::span<const BondProperty> bond_properties();

struct BondRows {
  std::vector<GrainBond> bonds;
  std::vector<std::string> places;  ///< "bonds.csv:3" of each, for messages
  /// Strength of one bond, N/m; none: the file has no such column, or an empty cell.
  struct Strength {
    std::optional<double> tension, shear;
    [[nodiscard]] bool given() const { return tension || shear; }
  };
  std::vector<Strength> strengths;  ///< of each
};

/// Rows "i,j,..." under a row of names; columns named like a property of a bond, and tension and shear, set it; others
/// are not read.
/// \param common properties where the file has no column or an empty cell
/// \throws Error (bad_input) with file and line: the first columns are not i and j, numbers of grains that are not
///         whole, properties that are negative or not finite
BondRows read_bonds(const std::filesystem::path& path, const GrainBond& common);

}  // namespace equidem
