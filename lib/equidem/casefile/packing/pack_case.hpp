// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A case that fills a box, as typed values; its tables [packing] and [settling], which an assembly that is a packing
/// has too.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "equidem/assembly/files.hpp"
#include "equidem/casefile/engine/bind.hpp"
#include "equidem/casefile/engine/keys.hpp"
#include "equidem/casefile/engine/toml.hpp"
#include "equidem/material/inertia.hpp"
#include "equidem/packing/measures.hpp"
#include "equidem/packing/packing.hpp"
#include "equidem/packing/size_distribution.hpp"

namespace equidem {

/// A checked case: complete, in range and without contradiction.
struct PackCase : CaseDocument {
  PackingOptions packing;
  NetworkOptions network;              ///< of the assembly that is written; no springs where the case weights them
  std::optional<Rectangle> region;     ///< region of measurement
  std::optional<double> density;       ///< kg/m³, of the bodies; none: see body_density
  std::optional<double> of_continuum;  ///< kg/m³, of bodies and voids together
  Body body = Body::disc;
  bool csv = true, picture = true;
  AssemblyFormat assembly = AssemblyFormat::json;

  /// Whether the bodies that are written have a density: the case gives it, or they fell with the default.
  [[nodiscard]] bool has_density() const { return density || of_continuum || entry_of(packing.method).open_top; }
};

/// The density of the bodies, kg/m³, as disc_density says; that of SettlingOptions where the case states none.
/// \param network of the packing
/// \throws Error (bad_input), with the line of the case file, as disc_density
double body_density(const PackCase& resolved, Assembly network);

/// The tables and keys of a case that fills a box.
const casefile::FileSpec& pack_file_spec();

/// The case file of a packing, or a case file whose [assembly] is one.
/// \param overrides "packing.seed=3", in order
/// \throws Error (bad_input) with file, line and key
PackCase read_pack_case(const std::filesystem::path& path, std::span<const std::string> overrides = {});

/// Read and check a case from text.
PackCase parse_pack_case(std::string_view text, const std::string& name, const std::filesystem::path& folder,
                         std::span<const std::string> overrides = {});

}  // namespace equidem

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
