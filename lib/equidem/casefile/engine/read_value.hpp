// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Values of a checked document, by key; for the readers of its tables.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "equidem/casefile/engine/toml.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/core/vector.hpp"

namespace equidem::casefile {

/// Throw an Error (bad_input) that names the line of a value, and the key.
[[noreturn]] inline void fail_at(const TomlValue& at, const std::string& key, const std::string& problem,
                                 const std::string& why, const std::string& remedy) {
  bad_input_at(fmt::format("{}: {}", at.where(), key), problem, why, remedy);
}

/// The result of a step; its Error gets a place, unless it has one.
template <class Step>
auto with_place(const std::string& where, const Step& step) {
  try {
    return step();
  } catch (const Error& error) {
    throw error.at(where);
  }
}

/// The result of a step; its Error gets the line of that key of the table.
template <class Step>
auto with_key(const TomlValue& table, const std::string& path, const char* key, const Step& step) {
  return with_place(fmt::format("{}: {}.{}", table.find(key)->where(), path, key), step);
}

/// The result of a step of the library: its Error, whose place may be the name of an option, gets the line of that key
/// of the table, or of the table.
/// \param usual the key of an Error without a place; empty: that of the table
template <class Step>
auto at_key(const TomlValue& table, const std::string& path, const Step& step, const std::string& usual = {}) {
  try {
    return step();
  } catch (const Error& error) {
    if (error.kind() == ErrorKind::interrupted) throw;
    const std::string& option = error.where().empty() ? usual : error.where();
    const TomlValue* key = option.empty() ? nullptr : table.find(option);
    throw Error(error.kind(), error.problem(), error.why(), error.remedy(),
                key == nullptr ? fmt::format("{}: {}", table.where(), path)
                               : fmt::format("{}: {}.{}", key->where(), path, option));
  }
}

/// The tables of a list such as [[load]]; empty if there are none.
const std::vector<TomlValue>& repeated(const TomlValue& root, const char* name);

/// A path of the file, resolved against its folder.
std::filesystem::path opened(const std::filesystem::path& written, const std::filesystem::path& folder);

/// \throws Error (bad_input) where two tables of a list have one name, or a name is empty
void check_names(const TomlValue& root, const char* list, const std::string& prefix = {});

/// \param what "a load case"
/// \param use "it becomes part of the names of files"
/// \throws Error (bad_input) where the text holds more than letters, digits, '_' and '-'
void check_plain_name(const TomlValue& value, const std::string& key, const std::string& what, const std::string& use);

/// \throws Error (bad_input) where the corners of a box are not in ascending order
void check_box(const TomlValue& given, const std::string& key, Vec2 low, Vec2 high);

}  // namespace equidem::casefile
