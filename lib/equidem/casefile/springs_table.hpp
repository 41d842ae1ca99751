// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// [springs] of a case, or the springs file that stands in its place (schema "equidem-springs/1").
#pragma once

#include <filesystem>
#include <initializer_list>
#include <optional>
#include <string>
#include <vector>

#include "equidem/casefile/engine/bind.hpp"
#include "equidem/contact/contact_springs.hpp"
#include "equidem/material/spring_constants.hpp"

namespace equidem::casefile {

struct SpringsTable {
  SpringConstants constants;  ///< Pa, before weighting
  SpringWeighting weighting = SpringWeighting::uniform;
  std::optional<double> density;  ///< kg/m³, of the discs that these springs are for
  BendingOptions bending;
};

std::vector<Key<SpringsTable>> springs_keys();
/// Keys of bonds, which colliding bodies have not.
std::vector<Key<SpringsTable>> bond_keys();

/// Binds `springs = "FILE"` at the top of a case file.
template <class F>
void bind_springs_file(File<F>& file) {
  file.table("").keys({unbound_key<F>("springs", KeyType::path,
                                      "a springs file, as calibrate writes it, in place of the table [springs]")});
}

/// The table of a springs file takes the place of its name.
/// \throws Error (bad_input) as resolve_table_file
void resolve_springs_file(TomlValue& root, const std::filesystem::path& folder);

/// Density of the discs as one table states it.
struct StatedDensity {
  const char* table;
  std::optional<double> value;  ///< kg/m³
};

/// The density that the tables state; none where none does.
/// \throws Error (bad_input) where two of them differ by more than 1e-6
std::optional<double> one_density(const TomlValue& root, std::initializer_list<StatedDensity> stated);

}  // namespace equidem::casefile

namespace equidem {

/// A springs file, which `springs = "FILE"` of a case file names; it reads back to the same bits.
/// \param comment lines for people at the top of the file, may be empty
/// \param density kg/m³, of the discs; none: not written
/// \param bond_width as BendingOptions; none: not written
std::string springs_file(const SpringConstants& springs, SpringWeighting weighting, std::optional<double> density,
                         std::optional<double> bond_width, const std::string& title, const std::string& comment);

}  // namespace equidem
