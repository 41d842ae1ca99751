// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Keys, tables and words that files of earlier versions have and options that their command lines have: each is an
/// error that says what to use instead.
#pragma once

#include <span>
#include <string_view>

namespace equidem::casefile {

struct RemovedKey {
  std::string_view table;   ///< in which the key stands, "" at the top of the file; of [stage.X] that of [X] holds too
  std::string_view name;    ///< of a key or table
  std::string_view value;   ///< a word that the key no longer takes; "": the key or table itself
  std::string_view remedy;  ///< what to use instead, a sentence without its full stop
};

/// An option (with its dashes) or a verb.
struct RemovedWord {
  std::string_view word;
  std::string_view remedy;
};

std::span<const RemovedKey> removed_keys();
std::span<const RemovedWord> removed_words();

/// The row of a key, or of one of its words; null where there is none.
const RemovedKey* removed_key(std::string_view table, std::string_view name, std::string_view value = "");
const RemovedWord* removed_word(std::string_view word);

}  // namespace equidem::casefile
