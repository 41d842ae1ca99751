// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The keys of the case file, in one table: parsing, errors and documentation are derived from it.
#pragma once

#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "equidem/casefile/toml.hpp"

namespace equidem {

enum class KeyType {
  text,
  choice,          ///< one of the words of KeySpec::choices
  path,            ///< of a file, relative to the folder of the case file
  flag,            ///< true | false
  whole,           ///< whole number
  number,          ///< finite
  vector,          ///< [x, y]
  number_or_auto,  ///< a number, or "auto"
  box,             ///< [x_min, y_min, x_max, y_max]
  discs,           ///< [0, 1, 2, ...]
  circles,         ///< [[x, y, radius], ...]
  sizes,           ///< ascending whole numbers, [100, 400, 1600]
  numbers,         ///< [0.0, 0.5, ...]
  words,           ///< a list of words of KeySpec::choices
  held,            ///< a number, or true for 0
  bytes,           ///< a number of bytes, or text such as "4 GB"
};

/// Numbers that a key accepts.
struct Range {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  bool low_open = false;
  bool high_open = false;
  bool zero_excluded = false;

  static constexpr Range positive() { return {.low = 0, .low_open = true}; }
  static constexpr Range not_negative() { return {.low = 0}; }
  static constexpr Range from(double low, double high) { return {.low = low, .high = high}; }

  [[nodiscard]] bool contains(double value) const;
  /// "> 0", "from 1 to 100", ">= 0 and < 0.5", "not 0"; empty for any number.
  [[nodiscard]] std::string text() const;
};

/// One key. A key whose meaning or need depends on the kind of its table has one entry for each.
struct KeySpec {
  const char* table;  ///< "assembly", "assembly.radii", "load"; "" at the top of the file
  const char* name;
  KeyType type;
  const char* unit = "";
  const char* fallback = required;  ///< default as TOML text, or `required`, or `none`
  Range range = {};
  std::vector<std::string> choices = {};
  std::vector<std::string> later = {};  ///< choices that are planned but not built
  const char* when_key = "";            ///< the key applies only where this key of the same table ...
  std::vector<std::string> when = {};   ///< ... is one of these
  const char* help = "";

  static constexpr const char* required = "required";
  static constexpr const char* none = "none";
  [[nodiscard]] bool is_required() const { return std::string_view(fallback) == required; }
  [[nodiscard]] bool has_default() const { return !is_required() && std::string_view(fallback) != none; }
};

/// One table of the file.
struct TableSpec {
  const char* name;       ///< "assembly", "assembly.radii", "load"
  bool repeated = false;  ///< [[load]]
  bool required = false;
  bool completed = false;  ///< missing: added with the defaults of its keys
  const char* when_key = "";
  std::vector<std::string> when = {};
  const char* help = "";
};

/// A kind of file: the tables and keys that it may have.
struct FileSpec {
  const char* schema;
  const char* noun;  ///< "case file"
  std::vector<TableSpec> tables;
  std::vector<KeySpec> keys;
};

/// The case file, schema "equidem/1".
const FileSpec& case_file_spec();
/// The springs file, schema "equidem-springs/1".
const FileSpec& springs_file_spec();

/// Every key of the case file with type, unit, range, default and meaning, as text of at most 100 columns.
std::string describe_case_file();

/// Check a document against its table of keys and fill in the defaults: afterwards every key that applies and has a
/// default is there, with the right type and in range.
/// \throws Error (bad_input), where = "file:line: table.key": unknown key (with the nearest known one), wrong type,
///         missing key, a number that is not finite or out of range, a key that does not apply
void check_and_complete(TomlValue& root, const FileSpec& spec);

/// Whether a path such as "springs.kT" or "load.0.moment" names a key of the case file.
bool is_known_key(std::string_view path);

/// Bytes meant by a value of KeyType::bytes; none where it is not one.
std::optional<double> bytes_of(const TomlValue& value);

/// Set one key of a document as `--set` does: "springs.kT=0.3e9", "load.0.moment=2" (entries of repeated tables count
/// from 0). The value is TOML; a bare word is taken as text, but none takes out the key, or one of several tables.
/// Missing tables are made.
/// \throws Error (bad_input) where this is no assignment, the value is no TOML, the path leads through a value, or
///         there is
///         nothing to take out
void apply_override(TomlValue& root, const std::string& assignment, const std::string& option = "--set");

/// The value at a path such as "load.0.group"; where it ends early, the last value on it.
const TomlValue& value_at(const TomlValue& root, std::string_view path);

}  // namespace equidem
