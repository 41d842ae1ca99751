// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Bodies of a CSV file, such as grains.csv of a run or of a packing.
///
/// Properties of bonds by name, and bonds of a CSV file, such as bonds.csv of a run or of a packing.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "equidem/grains/scene/grain_scene.hpp"
#include "equidem/grains/scene/grain_shapes.hpp"

namespace equidem {

/// Bodies with what their rows say besides; arrays of equal length.
struct GrainRows {
  std::vector<Grain> grains;
  std::vector<double> densities;    ///< kg/m³
  std::vector<std::string> groups;  ///< "grains" where none is given
  std::vector<int> lines;           ///< in the file, from 1
};

/// The first row names the columns, in any order: x, y, radius, or discs of a clump as "x y r; x y r"; where wanted
/// short_half_axis, vx, vy, spin, angle, density, group; also with their units, as a run writes them ("x_m"). A file
/// of a run has further columns, which are not read.
/// \param density kg/m³, of bodies in a file without that column; none: the column is needed
/// \param shapes in which distinct clumps are kept
/// \param cell width and height of the periodic cell in which the bodies are to lie, m; none: there is no such cell
/// \throws Error (bad_input) with file and line: no row of names, columns that are unknown, missing, in another unit or
///         there twice, the period of a packing that is not that of the cell, cells that are no numbers, a density that
///         is missing or not positive, a group that is called "walls", shapes as GrainShapes
GrainRows read_grains(const std::filesystem::path& path, std::optional<double> density, GrainShapes& shapes,
                      const std::optional<Vec2>& cell = {});

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
