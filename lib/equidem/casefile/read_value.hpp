// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Values of a checked document, by key; for the readers of its tables.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "equidem/casefile/toml.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/core/vector.hpp"

namespace equidem {

/// Throw an Error (bad_input) that names the line of a value, and the key.
[[noreturn]] inline void fail_at(const TomlValue& at, const std::string& key, const std::string& problem,
                                 const std::string& why, const std::string& remedy) {
  throw Error(ErrorKind::bad_input, problem, why, remedy, fmt::format("{}: {}", at.where(), key));
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
inline Vec2 vector(const TomlValue& table, const char* key) {
  const auto& items = table.find(key)->items;
  return {items[0].real, items[1].real};
}
/// Where the key may be missing.
inline std::optional<double> optional_number(const TomlValue& table, const char* key) {
  const TomlValue* value = table.find(key);
  return value == nullptr ? std::nullopt : std::optional(value->real);
}

/// The tables of a list such as [[load]]; empty where there are none.
const std::vector<TomlValue>& repeated(const TomlValue& root, const char* name);

/// A path of the file as the program opens it.
std::filesystem::path opened(const std::filesystem::path& written, const std::filesystem::path& folder);

/// \throws Error (bad_input) where two tables of a list have one name, or a name is empty
void check_names(const TomlValue& root, const char* list);

/// Of letters, digits, '_' and '-' alone.
bool is_plain_name(std::string_view name);

/// \param what "a load case"
/// \param use "it becomes part of the names of files"
/// \throws Error (bad_input) where the text holds more than letters, digits, '_' and '-'
void check_plain_name(const TomlValue& value, const std::string& key, const std::string& what, const std::string& use);

}  // namespace equidem
