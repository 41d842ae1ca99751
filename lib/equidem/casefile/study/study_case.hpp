// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A study file, as typed values.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "equidem/casefile/engine/keys.hpp"
#include "equidem/casefile/engine/toml.hpp"
#include "equidem/core/names.hpp"
#include "equidem/study/study.hpp"

namespace equidem {

/// A key that a study varies.
struct VariedKey {
  std::vector<std::string> keys;  ///< of the case, with the same value: "assembly.rows", "assembly.columns"
  std::vector<double> values;
  std::vector<std::string> names;  ///< in place of values: words that the keys take, each another method
  std::vector<double> orders;      ///< of theory with each of the names; empty: StudyCase::order
  /// Whether larger or smaller values are finer levels.
  enum class Refines { larger, smaller, not_at_all } refines = Refines::larger;
};

template <>
struct EnumNames<VariedKey::Refines> {
  using enum VariedKey::Refines;
  static constexpr const char* what = "kind of refinement";
  static constexpr NamedValue<VariedKey::Refines> list[] = {
      {larger, "larger"}, {smaller, "smaller"}, {not_at_all, "not"}};
};

/// A checked study file.
struct StudyCase : CaseDocument {
  std::string verb = "solve";
  std::filesystem::path case_file;  ///< path resolved against the folder of the file
  std::string measure;              ///< "poisson_ratio.plane_strain"
  Truth truth = Truth::finest;
  double value = 0;  ///< Truth::known
  std::optional<double> order;
  bool relative = true;
  std::vector<VariedKey> varied;  ///< at least one
};

/// The tables and keys of a study file.
const casefile::FileSpec& study_file_spec();

/// \throws Error (bad_input) with file, line and key
StudyCase read_study_case(const std::filesystem::path& path);

/// Read and check a study from text.
StudyCase parse_study_case(std::string_view text, const std::string& name, const std::filesystem::path& folder);

/// The trials: every combination of the values, as overrides "assembly.rows=33" of the case, with its setting.
struct StudyPoint {
  Setting setting;
  std::vector<std::string> overrides;
};
std::vector<StudyPoint> points_of(const StudyCase& study);

}  // namespace equidem
