// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// TOML as a plain tree of values with their line numbers; toml.cpp is the only place that includes toml++.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "equidem/core/names.hpp"

namespace equidem {

struct TomlEntry;

/// One value of a TOML document; tables keep the order of the file.
struct TomlValue {
  enum class Type { table, array, integer, real, boolean, text, date };

  Type type = Type::table;
  std::int64_t integer = 0;
  double real = 0;  ///< also set where type is integer
  bool boolean = false;
  bool is_path =
      false;  ///< text is a path resolved against the folder of the file; the echo makes it relative to its folder
  std::string text;
  std::string path;                ///< "load.force": of the value and of the items in it; "" at the top
  std::vector<TomlValue> items;    ///< of an array
  std::vector<TomlEntry> entries;  ///< of a table

  std::shared_ptr<const std::string> source;  ///< file name, or the option of the command line
  int line = 0;                               ///< in the file, from 1; 0: none

  [[nodiscard]] bool is_table() const { return type == Type::table; }
  [[nodiscard]] bool is_array() const { return type == Type::array; }
  [[nodiscard]] bool is_number() const { return type == Type::integer || type == Type::real; }
  /// The entry of that name of a table, of that number ("0", "1", ...) of an array; nullptr if there is none.
  [[nodiscard]] const TomlValue* find(std::string_view name) const;
  [[nodiscard]] TomlValue* find(std::string_view name);
  /// "cases/a.toml:7", or the option of the command line.
  [[nodiscard]] std::string where() const;
  /// "cases/a.toml:7: load.force".
  [[nodiscard]] std::string place() const;
  /// "a table", "an array", "text", ...: for messages.
  [[nodiscard]] std::string type_name() const;
  /// The value in short, as TOML: `21`, `"hexagonal"`, `nan`.
  [[nodiscard]] std::string shown() const;
};

/// An entry of a table.
struct TomlEntry {
  std::string name;
  TomlValue value;
};

template <>
struct EnumNames<TomlValue::Type> {
  using enum TomlValue::Type;
  static constexpr const char* what = "type";
  static constexpr NamedValue<TomlValue::Type> list[] = {
      {table, "a table"}, {array, "an array"},        {integer, "a whole number"},
      {real, "a number"}, {boolean, "true or false"}, {text, "text"},
      {date, "a date"}};
};

/// The value at a path such as "load.0.group"; if the path ends early, the last value on it.
const TomlValue& value_at(const TomlValue& root, std::string_view path);

/// Base of the cases of all kinds of files.
struct CaseDocument {
  std::string title;
  /// Defaults filled in; paths as the program opens them.
  TomlValue document;

  /// "cases/a.toml:7: load.0.group": place in the user's input, for error messages.
  [[nodiscard]] std::string where(std::string_view key) const;
  /// Headings of those of some tables that the document has: {"[test]", "[[load]]"}.
  [[nodiscard]] std::vector<std::string> headings(std::span<const char* const> tables) const;
};

/// Sets the path of a value and of all in it.
void set_paths(TomlValue& value, const std::string& path = {});

/// \param source name of the file, for messages
/// \throws Error (bad_input) with file and line where the text is not TOML
TomlValue parse_toml(std::string_view text, const std::string& source);

/// A document as TOML text.
/// \param document its paths as the program opens them
/// \param folder of the new file: paths are written relative to it
std::string to_toml(TomlValue document, const std::filesystem::path& folder);

/// A comment with a checksum of what stands in the files that a document reads, behind which a computation that goes on
/// later finds out whether they are the same; empty: it reads none. Files that [output] names are written, not read.
/// \param document its paths as the program opens them
/// \param further files, of which those that exist count
std::string note_of_files(const TomlValue& document, std::span<const std::filesystem::path> further = {});

/// How to write a number that TOML does not take as it is: ".7e8", "7.e8", "0,25", "1e8 Pa"; none of other texts.
struct NumberAdvice {
  std::string why, remedy;
};
std::optional<NumberAdvice> number_advice(std::string_view text);
/// Name and version of the parser, "toml++ 3.3.0".
std::string toml_parser();

/// Text as a TOML basic string, in quotes.
std::string toml_text(std::string_view text);
/// A number in the shortest form that reads back to the same bits, always with a point or an exponent.
std::string toml_number(double value);

}  // namespace equidem
