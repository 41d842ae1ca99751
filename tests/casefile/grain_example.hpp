// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A small valid case of grains, and how tests read it.
#pragma once

#include <string>
#include <vector>

#include "equidem/casefile/grains/grain_case.hpp"

#include "casefile/example.hpp"
#include "support/refusal.hpp"

namespace equidem::test {

inline const std::string grain_case = case_text("grains.toml");

inline GrainCase grains(const std::string& text, const std::vector<std::string>& overrides = {}) {
  return parse_grain_case(text, "a.toml", "", overrides);
}

/// The sentence of the error of a case, or of its automatic step; empty where it is accepted.
inline std::string sentence_of(const std::string& text, const std::vector<std::string>& overrides = {}) {
  return test::refusal_of([&] {
           const GrainCase resolved = grains(text, overrides);
           choose_grain_step(resolved);
         })
      .message;
}

}  // namespace equidem::test
