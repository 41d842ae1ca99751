// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A case that fills a box, as typed values.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "equidem/assembly/files.hpp"
#include "equidem/casefile/engine/keys.hpp"
#include "equidem/casefile/engine/toml.hpp"
#include "equidem/material/inertia.hpp"
#include "equidem/packing/measures.hpp"
#include "equidem/packing/methods.hpp"
#include "equidem/packing/packing.hpp"

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
