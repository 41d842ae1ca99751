// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// [springs] and [strength] of a case, or the springs file (schema "equidem-springs/1") and the strength file (schema
/// "equidem-strength/1") that stand in their place: `springs = "FILE"`; and [strength_target].
#pragma once

#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <optional>
#include <string>
#include <vector>

#include "equidem/breakage/calibrate/calibrate_strength.hpp"
#include "equidem/breakage/strengths.hpp"
#include "equidem/casefile/engine/bind.hpp"
#include "equidem/contact/contact_springs.hpp"
#include "equidem/core/text.hpp"
#include "equidem/material/spring_relations.hpp"

namespace equidem {

/// A springs file, which `springs = "FILE"` of a case file names; it reads back to the same bits.
/// \param comment lines for people at the top of the file, may be empty
/// \param density kg/m³, of the discs; none: not written
/// \param bond_width as BendingOptions; none: not written
std::string springs_file(const SpringConstants& springs, SpringWeighting weighting, std::optional<double> density,
                         std::optional<double> bond_width, const std::string& title, const std::string& comment);

/// [strength_target]: strengths of the material, for which calibrate finds those of the contacts.
struct StrengthTargetCase {
  StrengthTargets wanted;
  StrengthTestOptions test;
  std::optional<double> shear_over_tension;
  std::int64_t samples = 5;
};

/// A strength file, which `strength = "FILE"` of a case file names; it reads back to the same bits.
/// \param strengths with tension and shear
/// \param comment lines for people at the top of the file
std::string strength_file(const StrengthOptions& strengths, const std::string& title, const std::string& comment);

}  // namespace equidem

namespace equidem::casefile {

/// Binds `TABLE = "FILE"` at the top of a case file.
template <class F>
void bind_table_file(File<F>& file, const std::string& table) {
  file.table("").keys({unbound_key<F>(
      table, KeyType::path, fmt::format("a {0} file, as calibrate writes it, in place of the table [{0}]", table))});
}

struct SpringsTable {
  SpringConstants constants;  ///< Pa, before weighting
  SpringWeighting weighting = SpringWeighting::uniform;
  std::optional<double> density;  ///< kg/m³, of the discs that these springs are for
  BendingOptions bending;
};

/// \param with_bending the keys of bonds, too, which colliding bodies have not
std::vector<Key<SpringsTable>> springs_keys(bool with_bending);

/// The table of a springs file takes the place of its name.
/// \throws Error (bad_input) with file, line and key: a file that cannot be read, or is of another format
void resolve_springs_file(TomlValue& root, const std::filesystem::path& folder);

/// Density of the discs as one table states it.
struct StatedDensity {
  const char* table;
  std::optional<double> value;  ///< kg/m³
};

/// The density that the tables state; none where none does.
/// \throws Error (bad_input) where two of them differ by more than 1e-6
std::optional<double> one_density(const TomlValue& root, std::initializer_list<StatedDensity> stated);

std::vector<Key<StrengthOptions>> strength_keys();
std::vector<Key<StrengthTargetCase>> strength_target_keys();

/// The table of a strength file takes the place of its name.
/// \param keys that it may have
/// \throws Error (bad_input) as resolve_springs_file
void resolve_strength_file(TomlValue& root, const std::filesystem::path& folder,
                           const std::vector<Key<StrengthOptions>>& keys = strength_keys());

/// \throws Error (bad_input) with the line: strengths of contacts beside [strength_target], which asks for them
void check_strength_target(const TomlValue& root);

}  // namespace equidem::casefile
