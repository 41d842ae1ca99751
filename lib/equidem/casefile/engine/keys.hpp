// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Description of the keys and tables of a file: checks, errors, help and the reference page follow from it. Dialects
/// bind their keys to options structs with bind.hpp, which fills these descriptions.
/// Keys, tables and words that files of earlier versions have and options that their command lines have: each is an
/// error that says what to use instead.
#pragma once

#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "equidem/casefile/engine/toml.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/names.hpp"

namespace equidem {

/// The kinds of case files.
enum class CaseKind { assembly, colliding, packing, study };

template <>
struct EnumNames<CaseKind> {
  using enum CaseKind;
  static constexpr const char* what = "kind of case";
  static constexpr NamedValue<CaseKind> list[] = {
      {assembly, "assemblies"}, {colliding, "colliding bodies"}, {packing, "packings"}, {study, "studies"}};
};

}  // namespace equidem

namespace equidem::casefile {

enum class KeyType {
  text,
  two_names,       ///< ["quartz", "mica"], twice the same too
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

/// A condition on a key and others of its table. A number set to "auto" counts as not given; so do keys and tables that
/// do not apply.
struct KeyRelation {
  enum class Kind {
    exactly_one,  ///< the key or one of the others is given
    at_most_one,  ///< none of the others is given beside the key, nor beside another
    only_with,    ///< the key is given beside one of the others only
  } kind;
  std::vector<std::string> others;
  std::string why;  ///< for messages
};

/// A word that a user may take for a choice, refused with a reason of its own.
struct RefusedWord {
  std::string word, why, remedy;
};

/// One key.
struct KeySpec {
  std::string table;  ///< "assembly", "assembly.radii", "load"; "" at the top of the file
  std::string name;
  KeyType type;
  std::string unit = {};
  std::string fallback = required;  ///< default as TOML text, or `required`, or `none`
  Range range = {};
  std::vector<std::string> choices = {};
  std::string when_key = {};           ///< the key applies only where this key of the same table ...
  std::vector<std::string> when = {};  ///< ... is one of these
  std::vector<KeyRelation> relations = {};
  std::string help = {};
  std::vector<RefusedWord> refused = {};
  bool may_be_empty = false;         ///< of a list of words
  std::vector<CaseKind> kinds = {};  ///< of files that have the key; empty: all that have the table

  static constexpr const char* required = "required";
  static constexpr const char* none = "none";
  [[nodiscard]] bool is_required() const { return fallback == required; }
  [[nodiscard]] bool has_default() const { return !is_required() && fallback != none; }
  [[nodiscard]] std::string path() const { return table.empty() ? name : table + "." + name; }
};

/// One table of the file.
struct TableSpec {
  std::string name;       ///< "assembly", "assembly.radii", "load"
  bool repeated = false;  ///< [[load]]
  bool required = false;
  bool completed = false;     ///< missing: added with the defaults of its keys
  std::string when_key = {};  ///< of the table around it, or of another: "assembly.kind"
  std::vector<std::string> when = {};
  std::string help = {};
  std::string like = {};  ///< the table whose keys it has, for what differs; further keys are its own

  /// "[springs]", "[[load]]".
  [[nodiscard]] std::string heading() const { return repeated ? "[[" + name + "]]" : "[" + name + "]"; }
};

/// A kind of file: the tables and keys that it may have.
struct FileSpec {
  std::string schema;
  std::string noun;  ///< "case file"
  CaseKind kind = CaseKind::assembly;
  std::vector<TableSpec> tables = {};
  std::vector<KeySpec> keys = {};
  std::vector<KeySpec> others = {};  ///< keys that the same tables have in files of other kinds
  /// The kinds of files that have a table or key; null: not known.
  std::vector<CaseKind> (*kinds_with)(std::string_view path) = nullptr;

  [[nodiscard]] const TableSpec* table(std::string_view name) const;
  [[nodiscard]] const KeySpec* key(std::string_view table, std::string_view name) const;
};

/// "a number in Pa, > 0", `one of "square", "hexagonal"`: the values that a key accepts.
std::string expected(const KeySpec& key);

/// \throws Error (bad_input), where = "file:line: table.key": wrong type, out of range, not finite, no choice
void check_value(const TomlValue& value, const KeySpec& key);

/// The tables of a document as they are checked. A table follows the tables that it contains.
struct Visitor {
  std::function<void(const TableSpec&)> table;  ///< called for each table, one of a list included
  std::function<void(const KeySpec&, TomlValue&)>
      key;  ///< then for its keys; the specification is one of FileSpec::keys
};

/// Check a document against its table of keys and fill in the defaults: afterwards every key that applies and has a
/// default is present, with the right type and in range.
/// \throws Error (bad_input), where = "file:line: table.key": unknown key (with the nearest known one), wrong type,
///         missing key, a number that is not finite or out of range, a key that does not apply, a relation of keys that
///         does not hold
void check_and_complete(TomlValue& root, const FileSpec& spec, const Visitor& visitor);

/// The key of the file that a path such as "springs.kT" or "load.0.moment" names; null where there is none.
const KeySpec* known_key(const FileSpec& spec, std::string_view path);

/// Number of bytes of a value of KeyType::bytes; none if it is invalid.
std::optional<double> bytes_of(const TomlValue& value);

/// Set one key of a document as `--set` does: "springs.kT=0.3e9", "load.0.moment=2" (entries of repeated tables count
/// from 0). The value is TOML; a bare word is text, except `none`, which removes the key, or one of several tables.
/// Missing tables are created.
/// \throws Error (bad_input) if the text is not an assignment, the value is not TOML, the path leads through a value,
///         or there is nothing to remove
void apply_override(TomlValue& root, const std::string& assignment, const std::string& option = "--set");

/// A document with overrides applied.
/// \param source name of the file, for messages
/// \throws Error (bad_input) as parse_toml and apply_override
TomlValue parse_document(std::string_view text, const std::string& source, std::span<const std::string> overrides);
/// \throws Error (bad_input) as read_file and parse_document
TomlValue read_document(const std::filesystem::path& path, std::span<const std::string> overrides);

struct RemovedKey {
  std::string_view table;   ///< in which the key stands, "" at the top of the file; of [stage.X] that of [X] holds too
  std::string_view name;    ///< of a key or table
  std::string_view value;   ///< a word that the key no longer takes; "": the key or table itself
  std::string_view remedy;  ///< what to use instead, a sentence without its full stop
};

std::span<const RemovedKey> removed_keys();

/// The row of a key, or of one of its words; null where there is none.
const RemovedKey* removed_key(std::string_view table, std::string_view name, std::string_view value = "");

/// Refuses an option (with its dashes), a verb or a format of an earlier version. \param taker what took it
void refuse_removed_word(std::string_view word, std::string_view taker);

}  // namespace equidem::casefile
