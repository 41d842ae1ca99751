// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Values of a checked document, by key; for the readers of its tables.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "equidem/casefile/engine/toml.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

namespace equidem::casefile {

/// Throw an Error (bad_input) that names the line of a value, and the key.
[[noreturn]] inline void fail_at(const TomlValue& at, const std::string& key, const std::string& problem,
                                 const std::string& why, const std::string& remedy) {
  throw Error(ErrorKind::bad_input, problem, why, remedy, fmt::format("{}: {}", at.where(), key));
}

/// Check that exactly one of two keys is given.
/// \param missing the problem if neither is given; if both are given, the problem is "a and b are both given"
/// \param remedy what to do; `remedy_of_both` if both are given and the remedy differs
/// \throws Error (bad_input) at the second of both keys, or at the table
void check_one_of(const TomlValue& table, const std::string& path, const std::array<const char*, 2>& keys,
                  const std::string& missing, const std::string& why, const std::string& remedy,
                  const std::string& remedy_of_both = {});

/// Call a check of the library: its Error, whose place may be the name of an option, gets the line of that key of the
/// table, or of the table.
template <class Check>
void at_key(const TomlValue& table, const std::string& path, const Check& check) {
  try {
    check();
  } catch (const Error& error) {
    const TomlValue* key = error.where().empty() ? nullptr : table.find(error.where());
    throw Error(error.kind(), error.problem(), error.why(), error.remedy(),
                key == nullptr ? fmt::format("{}: {}", table.where(), path)
                               : fmt::format("{}: {}.{}", key->where(), path, error.where()));
  }
}

/// The tables of a list such as [[load]]; empty if there are none.
const std::vector<TomlValue>& repeated(const TomlValue& root, const char* name);

/// A path of the file, resolved against its folder.
std::filesystem::path opened(const std::filesystem::path& written, const std::filesystem::path& folder);

/// \throws Error (bad_input) where two tables of a list have one name, or a name is empty
void check_names(const TomlValue& root, const char* list);

/// Whether the text consists of letters, digits, '_' and '-' only.
bool is_plain_name(std::string_view name);

/// \param what "a load case"
/// \param use "it becomes part of the names of files"
/// \throws Error (bad_input) where the text holds more than letters, digits, '_' and '-'
void check_plain_name(const TomlValue& value, const std::string& key, const std::string& what, const std::string& use);

}  // namespace equidem::casefile
