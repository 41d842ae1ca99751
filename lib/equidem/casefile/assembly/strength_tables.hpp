// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// [strength] of a case, or the strength file that stands in its place (schema "equidem-strength/1"), and
/// [strength_target].
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "equidem/breakage/calibrate/calibrate_strength.hpp"
#include "equidem/breakage/strengths.hpp"
#include "equidem/casefile/engine/bind.hpp"

namespace equidem {

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

std::vector<Key<StrengthOptions>> strength_keys();
std::vector<Key<StrengthTargetCase>> strength_target_keys();

/// Binds `strength = "FILE"` at the top of a case file.
template <class F>
void bind_strength_file(File<F>& file) {
  file.table("").keys({unbound_key<F>("strength", KeyType::path,
                                      "a strength file, as calibrate writes it, in place of the table [strength]")});
}

/// The table of a strength file takes the place of its name.
/// \param keys that it may have
/// \throws Error (bad_input) as resolve_table_file
void resolve_strength_file(TomlValue& root, const std::filesystem::path& folder,
                           std::vector<Key<StrengthOptions>> keys = strength_keys());

/// \throws Error (bad_input) with the line: strengths of contacts beside [strength_target], which asks for them
void check_strength_target(const TomlValue& root);

}  // namespace equidem::casefile
