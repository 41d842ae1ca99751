// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Cases with one thing wrong, and what their sentence must hold.
#pragma once

#include <algorithm>
#include <stdexcept>
#include <string>
#include <vector>

#include "support/catch.hpp"

namespace equidem::test {

struct Wrong {
  std::string what, by;  ///< in the text of a valid case
  std::string line;      ///< how the line at fault begins
  std::string key;
  std::vector<std::string> words;
};

/// "a.toml:7", where that line begins with `line`.
inline std::string place_of(const std::string& text, const std::string& line) {
  const auto at = text.find(line);
  if (at == std::string::npos) throw std::logic_error("no line begins with '" + line + "'");
  return "a.toml:" + std::to_string(1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n'));
}

inline void check_sentence(const std::string& text, const std::string& sentence, const Wrong& wrong) {
  const std::string start = place_of(text, wrong.line) + ": " + wrong.key + ": ";
  CAPTURE(wrong.by, sentence, start);
  CHECK(sentence.starts_with(start));
  for (const std::string& word : wrong.words) {
    CAPTURE(word);
    CHECK(sentence.find(word) != std::string::npos);
  }
  CHECK(sentence.find('\n') == std::string::npos);
  CHECK((sentence.ends_with(".") || sentence.ends_with("?")));
}

}  // namespace equidem::test
