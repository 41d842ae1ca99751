// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Cases with one thing wrong, and what their sentence must hold.
#pragma once

#include <algorithm>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "equidem/core/text.hpp"

#include "example.hpp"
#include "support/catch.hpp"

namespace equidem::test {

/// Where a sentence must point to, and what it must hold.
struct Wrong {
  std::string place;  ///< "a.toml:7" or "--set KEY=VALUE"
  std::string key;    ///< at fault; empty: none is named
  std::vector<std::string> words;
};

/// "a.toml:7" for a place in a text.
inline std::string line_at(const std::string& text, std::size_t at) {
  return "a.toml:" + std::to_string(1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n'));
}

/// The number of the line that begins with `line`.
inline std::string place_of(const std::string& text, const std::string& line) {
  const auto at = text.find(line);
  if (at == std::string::npos) throw std::logic_error("no line begins with '" + line + "'");
  return line_at(text, at);
}

inline void check_sentence(const std::string& sentence, const Wrong& wrong) {
  const std::string start = wrong.place + ": " + (wrong.key.empty() ? "" : wrong.key + ": ");
  CAPTURE(sentence, start);
  CHECK(sentence.starts_with(start));
  for (const std::string& word : wrong.words) {
    CAPTURE(word);
    CHECK(sentence.find(word) != std::string::npos);
  }
  CHECK(sentence.find('\n') == std::string::npos);
  CHECK((sentence.ends_with(".") || sentence.ends_with("?")));
}

/// A valid case with one thing wrong in each row of a table, "WHAT => BY | KEY | WORDS | WORDS ..." or
/// "--set KEY=VALUE | KEY | WORDS ...". "\n" breaks a line; the last line of BY is at fault, or in "WHAT => BY | @LINE
/// | KEY ..." the first that begins with LINE. A row that begins with two spaces goes on with the one before, one with
/// # is a comment. \param sentence_of of the text with overrides
template <class SentenceOf>
void check_wrong(const std::string& valid, std::string_view table, const SentenceOf& sentence_of) {
  const auto replaced = [](std::string text, const std::string& from, const std::string& to) {
    for (std::size_t at; (at = text.find(from)) != std::string::npos;) text.replace(at, from.size(), to);
    return text;
  };
  const std::string rows = replaced(std::string(table), "\n  |", " |");
  for (const std::string_view row : parts_of(rows, '\n')) {
    if (row.empty() || row.starts_with("#")) continue;
    std::vector<std::string> cells;
    for (std::string rest(row); !rest.empty();) {
      const bool empty = rest.starts_with("|");
      const std::size_t end = empty ? 0 : std::min(rest.find(" |"), rest.size());
      cells.push_back(replaced(rest.substr(0, end), "\\n", "\n"));
      rest.erase(0, end + (empty ? 2 : 3));
    }
    CAPTURE(row);
    REQUIRE(cells.size() > 2);
    Wrong wrong;
    std::string text = valid;
    std::vector<std::string> overrides;
    std::size_t next = 1;
    if (row.starts_with("--set ")) {
      wrong.place = cells[0];
      overrides = {cells[0].substr(6)};
    } else {
      const std::size_t arrow = cells[0].find(" =>");
      const std::string what = cells[0].substr(0, arrow), by = cells[0].substr(std::min(arrow + 4, cells[0].size()));
      const std::size_t at = valid.find(what), last = by.rfind('\n', by.size() - 2);
      text = changed(valid, what, by);
      const bool other = cells[1].starts_with("@");
      wrong.place = other ? place_of(text, cells[next++].substr(1))
                          : line_at(text, at + (by.size() < 2 || last == std::string::npos ? 0 : last + 1));
    }
    wrong.key = cells[next++];
    wrong.words.assign(cells.begin() + static_cast<std::ptrdiff_t>(next), cells.end());
    check_sentence(sentence_of(text, overrides), wrong);
  }
}

}  // namespace equidem::test
