// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A small valid case, and how tests read it.
#pragma once

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "equidem/casefile/assembly/case.hpp"
#include "equidem/core/file.hpp"

#include "support/refusal.hpp"

namespace equidem::test {

/// A file of tests/casefile/cases.
inline std::string case_text(const std::string& name) {
  return read_file(std::filesystem::path(EQUIDEM_SOURCE_DIR) / "tests/casefile/cases" / name);
}

inline const std::string tension_case = case_text("tension.toml");
inline const std::string load_case = case_text("loads.toml");
inline const std::string ensemble_case = case_text("ensemble.toml");
inline const std::string motion_case = case_text("motion.toml");

/// One of each kind: a test, supports and loads, many samples, motion in time.
inline const std::vector<std::string> example_cases = {tension_case, load_case, ensemble_case, motion_case};

inline Case parsed(const std::string& text, const std::vector<std::string>& overrides = {}) {
  return parse_case(text, "a.toml", ".", overrides);
}

/// Files data/cases/PREFIX*.toml; of "", those of assemblies.
inline std::vector<std::filesystem::path> cases_of_the_data_folder(const std::string& prefix) {
  std::vector<std::filesystem::path> found;
  for (const auto& entry : std::filesystem::directory_iterator(EQUIDEM_SOURCE_DIR "/data/cases")) {
    const std::string name = entry.path().filename().string();
    const bool other = name.starts_with("grains_") || name.starts_with("pack_") || name.starts_with("study_");
    if (name.ends_with(".toml") && (prefix.empty() ? !other : name.starts_with(prefix))) found.push_back(entry.path());
  }
  std::ranges::sort(found);
  return found;
}

/// The sentence of the error of a case; empty where it is accepted.
inline std::string error_of(const std::string& text, const std::vector<std::string>& overrides = {}) {
  const Refusal refused = refusal_of([&] { static_cast<void>(parsed(text, overrides)); });
  return (refused.kind == ErrorKind::bad_input ? "" : "wrong kind: ") + refused.message;
}

/// The text with the first `what` replaced.
inline std::string changed(std::string text, const std::string& what, const std::string& by) {
  const auto at = text.find(what);
  if (at == std::string::npos) throw std::logic_error("the example has no '" + what + "'");
  return text.replace(at, what.size(), by);
}

}  // namespace equidem::test
