// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The tables of a packing, [packing] and [settling]: of a case that fills a box, and of an assembly that is a packing.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "equidem/casefile/engine/bind.hpp"
#include "equidem/packing/measures.hpp"
#include "equidem/packing/methods.hpp"
#include "equidem/packing/packing.hpp"
#include "equidem/packing/size_distribution.hpp"

namespace equidem::casefile {

/// [packing], [packing.shape], [packing.radii] and [settling].
struct PackingTables {
  PackingOptions options;         ///< without radii and box
  std::optional<double> density;  ///< kg/m³, of the bodies
  double gap_tolerance = 0;
  std::optional<Rectangle> region;  ///< region of measurement
  PackingAmount amount;
  PackingBox::Sides sides = PackingBox::Sides::walls;
  SizeDistribution sizes;
  std::optional<std::filesystem::path> sieve_curve;
};

std::vector<Key<PackingTables>> packing_keys();
std::vector<Key<PackingShape>> packing_shape_keys();
std::vector<Key<PackingTables>> packing_radii_keys();
std::vector<Key<PackingTables>> settling_keys();

/// Binds the tables to a member of F.
/// \param condition attributes of all four tables, such as `when`
template <class F, class... Condition>
void bind_packing(File<F>& file, PackingTables F::*tables, const Condition&... condition) {
  file.table("packing", tables, required, "how many bodies fill which box", condition...).keys(packing_keys());
  file.table("packing.shape", tables, &PackingTables::options, &PackingOptions::shape, completed, "shape of the bodies",
             condition...)
      .keys(packing_shape_keys());
  file.table("packing.radii", tables, required, "radii of the bodies", condition...).keys(packing_radii_keys());
  file.table("settling", tables, completed, "how bodies fall and come to rest (method = falling)", condition...)
      .keys(settling_keys());
}

/// The options with radii drawn and box completed.
/// \param root document of the tables
/// \throws Error (bad_input), with file, line and key
ScalablePacking packing_options(const TomlValue& root, const PackingTables& tables);

}  // namespace equidem::casefile
