// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// What errors say.
#pragma once

#include <string>
#include <vector>

#include "equidem/core/error.hpp"

#include "support/catch.hpp"

namespace equidem::test {

/// The Error that a call throws; the message is empty where it throws none.
struct Refusal {
  std::string message, problem, remedy, where;
  ErrorKind kind = ErrorKind::bad_input;

  [[nodiscard]] bool says(const std::string& words) const { return message.find(words) != std::string::npos; }
};

template <typename Call>
Refusal refusal_of(Call&& call) {
  try {
    call();
  } catch (const Error& error) {
    return {error.what(), error.problem(), error.remedy(), error.where(), error.kind()};
  }
  return {};
}

/// The call is refused by a sentence with all these words.
template <typename Call>
Refusal check_refused(Call&& call, const std::vector<std::string>& words, ErrorKind kind = ErrorKind::bad_input) {
  const Refusal refusal = refusal_of(call);
  INFO("the sentence: " << (refusal.message.empty() ? "(accepted)" : refusal.message));
  CHECK_FALSE(refusal.message.empty());
  CHECK(refusal.kind == kind);
  for (const std::string& word : words) {
    INFO("looked for: " << word);
    CHECK(refusal.says(word));
  }
  return refusal;
}

}  // namespace equidem::test
