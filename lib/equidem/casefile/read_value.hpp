// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Values of a checked document, by key; for the readers of its tables.
#pragma once

#include <string>

#include "equidem/casefile/toml.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

namespace equidem {

/// Throw an Error (bad_input) that names the line of a value, and the key.
[[noreturn]] inline void fail_at(const TomlValue& at, const std::string& key, const std::string& problem,
                                 const std::string& why, const std::string& remedy) {
  throw Error(ErrorKind::bad_input, problem, why, remedy, format("{}: {}", at.where(), key));
}

/// The entry must exist and have the type: check_and_complete has seen to it.
inline double number(const TomlValue& table, const char* key) {
  return table.find(key)->real;
}
inline const std::string& text(const TomlValue& table, const char* key) {
  return table.find(key)->text;
}
inline int whole(const TomlValue& table, const char* key) {
  return static_cast<int>(table.find(key)->integer);
}
inline bool flag(const TomlValue& table, const char* key) {
  return table.find(key)->boolean;
}

}  // namespace equidem
