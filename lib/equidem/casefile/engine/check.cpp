// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>

#include "equidem/casefile/engine/bind.hpp"
#include "equidem/casefile/engine/keys.hpp"
#include "equidem/core/names.hpp"
#include "equidem/core/table_file.hpp"
#include "equidem/core/text.hpp"

namespace equidem::casefile {
namespace {

using Type = TomlValue::Type;

std::string quoted_list(const std::vector<std::string>& words) {
  return joined(words, [](const std::string& word) { return fmt::format("\"{}\"", word); });
}

[[noreturn]] void fail(const TomlValue& value, const KeySpec& key, const std::string& problem,
                       const std::string& remedy) {
  fail_at(value, problem, fmt::format("{} is {}", key.name, expected(key)), remedy);
}

/// A kind of value. In the texts {unit}, {range}, {choices} and {words} stand for those of the key, {number} for a
/// number in its range.
struct ValueKind {
  KeyType type;
  const char* expected;  ///< values that a key accepts
  const char* example;   ///< one of them, as TOML
  void (*check)(const TomlValue&, const KeySpec&);
};
const ValueKind& kind_of(KeyType type);

std::string filled(const char* text, const KeySpec& key) {
  const std::string words = quoted_list(key.choices);
  return fmt::format(fmt::runtime(text), fmt::arg("unit", key.unit.empty() ? "" : " in " + key.unit),
                     fmt::arg("range", key.range.text().empty() ? "" : ", " + key.range.text()),
                     fmt::arg("choices", (key.choices.size() == 1 ? "" : "one of ") + words), fmt::arg("words", words),
                     fmt::arg("first", key.choices.empty() ? "" : key.choices.front()),
                     fmt::arg("number", key.range.contains(1.0) ? "1.0" : "0.1"));
}

/// "Write it like key = example".
std::string like_example(const KeySpec& key) {
  return fmt::format("Write it like {} = {}", key.name, filled(kind_of(key.type).example, key));
}

[[noreturn]] void fail_type(const TomlValue& value, const KeySpec& key) {
  std::string remedy = like_example(key);
  if (value.type == Type::text && (key.type == KeyType::number || key.type == KeyType::number_or_auto ||
                                   key.type == KeyType::whole || key.type == KeyType::held)) {
    if (const auto advice = number_advice(value.text))
      fail_at(value, fmt::format("{} is text", value.shown()), advice->why, advice->remedy);
    if (number_from<double>(value.text)) remedy = fmt::format("Leave out the quotes: {} = {}", key.name, value.text);
  }
  if (value.type == Type::real && key.type == KeyType::whole && value.real == std::floor(value.real) &&
      std::abs(value.real) < 1e15)
    remedy = fmt::format("Write {} = {:.0f}", key.name, value.real);
  fail(value, key, fmt::format("{} is {}", value.shown(), value.type_name()), remedy);
}

[[noreturn]] void fail_range(const TomlValue& value, const KeySpec& key) {
  fail(value, key, fmt::format("{} is out of range", value.shown()), fmt::format("Give a number {}", key.range.text()));
}

void check_number(const TomlValue& value, const KeySpec& key) {
  if (!value.is_number()) fail_type(value, key);
  if (!std::isfinite(value.real))
    fail(value, key, fmt::format("{} is not a finite number", value.shown()), "Give a finite one");
  if (!key.range.contains(value.real)) fail_range(value, key);
}

template <std::size_t count>
void check_numbers(const TomlValue& value, const KeySpec& key) {
  if (!value.is_array()) fail_type(value, key);
  if (value.items.size() != count) {
    fail(value, key,
         fmt::format("{} has {}", value.shown(),
                     counted(static_cast<long long>(value.items.size()), "entry", "entries")),
         fmt::format("Give {} of them", count));
  }
  for (const TomlValue& item : value.items) check_number(item, key);
}

void check_discs(const TomlValue& value, const KeySpec& key) {
  if (!value.is_array()) fail_type(value, key);
  if (value.items.empty()) fail(value, key, "the list is empty", "Name at least one disc");
  for (const TomlValue& item : value.items) {
    if (item.type != Type::integer || item.integer < 0 || item.integer > INT32_MAX)
      fail(item, key, fmt::format("{} is no number of a disc", item.shown()), "Discs are counted 0, 1, 2, ...");
  }
}

/// A list that is not empty.
void check_list(const TomlValue& value, const KeySpec& key) {
  if (!value.is_array()) fail_type(value, key);
  if (value.items.empty()) fail(value, key, "the list is empty", like_example(key));
}

void check_list_of_numbers(const TomlValue& value, const KeySpec& key) {
  check_list(value, key);
  for (const TomlValue& item : value.items) check_number(item, key);
}

void check_circles(const TomlValue& value, const KeySpec& key) {
  check_list(value, key);
  for (const TomlValue& item : value.items) {
    if (!item.is_array()) fail_type(value, key);
    check_numbers<3>(item, key);
    if (!(item.items[2].real > 0))
      fail(item.items[2], key, fmt::format("the radius {} is out of range", item.items[2].shown()),
           "Give a number > 0");
  }
}

void check_sizes(const TomlValue& value, const KeySpec& key) {
  check_list(value, key);
  for (std::size_t k = 0; k < value.items.size(); ++k) {
    const TomlValue& item = value.items[k];
    if (item.type != Type::integer) fail_type(item, key);
    check_number(item, key);
    if (k > 0 && item.integer <= value.items[k - 1].integer) {
      fail(item, key, fmt::format("{} comes after {}", item.integer, value.items[k - 1].integer),
           "Write each number once, the smallest first");
    }
  }
}

void check_choice(const TomlValue& value, const KeySpec& key) {
  if (value.type != Type::text) fail_type(value, key);
  if (std::ranges::find(key.choices, value.text) != key.choices.end()) return;
  const std::string problem =
      fmt::format("{} is {} {}", value.shown(), key.type == KeyType::words ? "none of the" : "no known", key.name);
  if (const RemovedKey* removed = removed_key(key.table, key.name, value.text))
    fail_at(value, fmt::format("{} is of an earlier version", value.shown()),
            fmt::format("{} takes it no longer", key.name), std::string(removed->remedy));
  const auto refused = std::ranges::find(key.refused, value.text, &RefusedWord::word);
  if (refused != key.refused.end()) fail_at(value, problem, refused->why, refused->remedy);
  const auto meant = nearest(value.text, key.choices);
  fail(value, key, problem, meant ? fmt::format("Did you mean \"{}\"?", *meant) : "Choose one of these");
}

void check_words(const TomlValue& value, const KeySpec& key) {
  if (!(value.is_array() && key.may_be_empty)) check_list(value, key);
  for (std::size_t k = 0; k < value.items.size(); ++k) {
    check_choice(value.items[k], key);
    for (std::size_t earlier = 0; earlier < k; ++earlier)
      if (value.items[earlier].text == value.items[k].text)
        fail(value.items[k], key, fmt::format("{} is there twice", value.items[k].shown()), "Write each word once");
  }
}

void check_two_names(const TomlValue& value, const KeySpec& key) {
  if (!value.is_array() || value.items.size() != 2) fail_type(value, key);
  for (const TomlValue& item : value.items)
    if (item.type != Type::text) fail_type(value, key);
}

template <Type type>
void check_type(const TomlValue& value, const KeySpec& key) {
  if (value.type != type) fail_type(value, key);
}

void check_path(const TomlValue& value, const KeySpec& key) {
  check_type<Type::text>(value, key);
  if (value.text.empty()) fail(value, key, "the name is empty", "Name a file");
}

void check_whole(const TomlValue& value, const KeySpec& key) {
  const bool infinite = value.is_number() && !std::isfinite(value.real);
  if (value.type != Type::integer && !infinite) fail_type(value, key);
  check_number(value, key);
}

void check_number_or_auto(const TomlValue& value, const KeySpec& key) {
  if (value.type != Type::text || value.text != "auto") check_number(value, key);
}

void check_held(const TomlValue& value, const KeySpec& key) {
  if (value.type != Type::boolean) return check_number(value, key);
  if (!value.boolean) fail(value, key, "false is not allowed", fmt::format("Leave {} out where it is free", key.name));
}

void check_bytes(const TomlValue& value, const KeySpec& key) {
  const auto size = bytes_of(value);
  if (!size) fail_type(value, key);
  if (!key.range.contains(*size)) fail_range(value, key);
}

constexpr ValueKind kinds[] = {
    {KeyType::text, "text in quotes", "\"...\"", check_type<Type::text>},
    {KeyType::two_names, "two names in quotes, such as [\"quartz\", \"mica\"]", "[\"...\", \"...\"]", check_two_names},
    {KeyType::choice, "{choices}", "\"{first}\"", check_choice},
    {KeyType::path, "the name of a file, in quotes", "\"FILE\"", check_path},
    {KeyType::flag, "true or false", "true", check_type<Type::boolean>},
    {KeyType::whole, "a whole number{range}", "10", check_whole},
    {KeyType::number, "a number{unit}{range}", "{number}", check_number},
    {KeyType::vector, "two numbers [x, y]{unit}", "[1.0, 0.0]", check_numbers<2>},
    {KeyType::number_or_auto, "\"auto\", or a number{unit}{range}", "\"auto\"", check_number_or_auto},
    {KeyType::box, "four numbers [x_min, y_min, x_max, y_max]{unit}", "[0.0, 0.0, 1.0, 1.0]", check_numbers<4>},
    {KeyType::discs, "a list of disc numbers, such as [0, 1, 2]", "[0, 1, 2]", check_discs},
    {KeyType::circles, "a list of circles [x, y, radius]{unit}, radius > 0", "[[0.0, 0.0, 0.01], [0.015, 0.0, 0.01]]",
     check_circles},
    {KeyType::sizes, "a list of ascending whole numbers{range}", "[100, 400, 1600]", check_sizes},
    {KeyType::numbers, "a list of numbers{unit}{range}", "[0.0, 0.5, 1.0]", check_list_of_numbers},
    {KeyType::words, "a list of words out of {words}", "[\"{first}\"]", check_words},
    {KeyType::held, "a number{unit}, or true for 0", "0.001", check_held},
    {KeyType::bytes, "a number of bytes, or text such as \"4 GB\"", "\"4 GB\"", check_bytes},
};

const ValueKind& kind_of(KeyType type) {
  return *std::ranges::find(kinds, type, &ValueKind::type);
}

}  // namespace

std::string expected(const KeySpec& key) {
  return filled(kind_of(key.type).expected, key);
}

void check_value(const TomlValue& value, const KeySpec& key) {
  kind_of(key.type).check(value, key);
}

std::optional<double> bytes_of(const TomlValue& value) {
  if (value.is_number()) return value.real;
  if (value.type != Type::text) return {};
  double number = 0;
  const char* const end = value.text.data() + value.text.size();
  const auto [rest, problem] = std::from_chars(value.text.data(), end, number);
  if (problem != std::errc()) return {};
  std::string_view unit(rest, static_cast<std::size_t>(end - rest));
  while (!unit.empty() && unit.front() == ' ') unit.remove_prefix(1);
  struct Unit {
    std::string_view name;
    double bytes;
  };
  constexpr std::array units{Unit{"B", 1},        Unit{"kB", 1e3},     Unit{"MB", 1e6},
                             Unit{"GB", 1e9},     Unit{"TB", 1e12},    Unit{"KiB", 0x1p10},
                             Unit{"MiB", 0x1p20}, Unit{"GiB", 0x1p30}, Unit{"TiB", 0x1p40}};
  for (const Unit& known : units)
    if (unit == known.name) return number * known.bytes;
  return {};
}

namespace {

std::string key_path(const std::string& path, const std::string& name) {
  return path.empty() ? name : path + "." + name;
}

bool contains(const std::vector<std::string>& words, const std::string& word) {
  return std::ranges::find(words, word) != words.end();
}

bool is_list_of_tables(const TomlValue& value) {
  return value.is_array() && !value.items.empty() && value.items[0].is_table();
}

TomlValue default_of(const KeySpec& key) {
  return *parse_toml(fmt::format("value = {}", key.fallback), "").find("value");
}

/// Walks a document beside its table of keys.
class Checker {
 public:
  Checker(TomlValue& root, const FileSpec& spec, const Visitor& visitor)
      : root_(root), spec_(spec), visitor_(visitor) {}

  void run() {
    check_schema();
    check_table({}, root_);
    for (const TableSpec& table : spec_.tables) {
      const std::size_t dot = table.name.find('.');
      const bool inner = dot != std::string::npos;
      TomlValue* parent = inner ? root_.find(table.name.substr(0, dot)) : &root_;
      const std::string leaf = table.name.substr(inner ? dot + 1 : 0);
      if (parent == nullptr || parent->find(leaf) != nullptr) continue;
      if (!applies(inner ? table.name.substr(0, dot) : "", *parent, table)) continue;
      if (table.required)
        fail_at(root_, table.heading(), "missing table", fmt::format("it describes {}", table.help),
                "Add " + table.heading());
      if (table.completed) {
        TomlValue added;
        added.source = root_.source;
        added.path = table.name;
        check_table(table, added);
        parent->entries.push_back({leaf, std::move(added)});
      }
    }
  }

 private:
  void check_schema() const {
    const TomlValue* schema = root_.find("schema");
    const std::string remedy = fmt::format("Write schema = \"{}\" at the top of the file", spec_.schema);
    if (schema == nullptr)
      fail_at(root_, "schema", "missing key", fmt::format("every {} names the rules it follows", spec_.noun), remedy);
    if (schema->type == TomlValue::Type::text && schema->text == spec_.schema) return;
    fail_at(*schema, fmt::format("{} is not the schema of a {}", schema->shown(), spec_.noun),
            fmt::format("this program reads \"{}\"", spec_.schema), remedy);
  }

  /// The word on which other keys of the table depend, such as the kind of assembly; checked first.
  std::string selected(const std::string& path, const TomlValue& table, const std::string& name) const {
    const KeySpec* key = spec_.key(path, name);
    if (key == nullptr || !applies(path, table, *key)) return {};
    if (const TomlValue* value = table.find(name)) {
      check_value(*value, *key);
      return value->text;
    }
    if (key->is_required()) fail_missing(table, *key);
    return default_of(*key).text;
  }

  /// \param spec of a key or of a table inside the table
  template <class Spec>
  bool applies(const std::string& path, const TomlValue& table, const Spec& spec) const {
    if (spec.when_key.empty()) return true;
    const std::size_t dot = spec.when_key.find('.');
    if (dot == std::string::npos) return contains(spec.when, selected(path, table, spec.when_key));
    const std::string other = spec.when_key.substr(0, dot);
    const TomlValue* found = root_.find(other);
    return found != nullptr && found->is_table() &&
           contains(spec.when, selected(other, *found, spec.when_key.substr(dot + 1)));
  }

  [[noreturn]] void fail_missing(const TomlValue& table, const KeySpec& key) const {
    fail_at(table, key.name, "missing key", fmt::format("{} is needed", expected(key)),
            key.table.empty() ? fmt::format("Add {} = ... at the top of the file", key.name)
                              : fmt::format("Add {} = ... to {}", key.name, spec_.table(key.table)->heading()));
  }

  /// The keys and tables that a table may have.
  [[nodiscard]] std::vector<std::string> names_below(const std::string& path, const TomlValue& table) const {
    std::vector<std::string> names;
    for (const KeySpec& key : spec_.keys)
      if (path == key.table && applies(path, table, key)) names.push_back(key.name);
    const std::string prefix = key_path(path, "");
    for (const TableSpec& inner : spec_.tables) {
      if (!inner.name.starts_with(prefix)) continue;
      const std::string leaf = inner.name.substr(prefix.size());
      if (leaf.find('.') == std::string::npos && !contains(names, leaf)) names.push_back(leaf);
    }
    return names;
  }

  /// Keys that are wanted, of tables that the document has where there are some, else of all.
  template <class Wanted>
  [[nodiscard]] std::vector<const KeySpec*> keys_elsewhere(const Wanted& wanted) const {
    std::vector<const KeySpec*> present, all;
    for (const KeySpec& key : spec_.keys) {
      if (!wanted(key)) continue;
      all.push_back(&key);
      const TomlValue* const table = key.table.empty() ? &root_ : root_.find(key.table);
      if (table != nullptr && table->is_table() && applies(key.table, *table, key)) present.push_back(&key);
    }
    return present.empty() ? all : present;
  }

  static std::string listed_paths(const std::vector<const KeySpec*>& keys) {
    std::vector<std::string> paths;
    for (const KeySpec* key : keys) paths.push_back(key->path());
    return listed(paths, " or ");
  }

  /// \param by_option whether the key was set on the command line
  [[nodiscard]] std::string place_of(const std::vector<const KeySpec*>& keys, bool by_option) const {
    if (by_option) return "Write " + listed_paths(keys);
    std::vector<std::string> headings;
    for (const KeySpec* key : keys) {
      if (key->table.empty()) return "It belongs at the top of the file, before the first [table]";
      headings.push_back(spec_.table(key->table)->heading());
    }
    return "It belongs to " + listed(headings, " or ");
  }

  [[noreturn]] void fail_unknown(const std::string& path, const TomlValue& table, const std::string& name,
                                 const TomlValue& value) const {
    if (const RemovedKey* removed = removed_key(path, name))
      fail_at(value, fmt::format("{} is of an earlier version", name),
              fmt::format("the {} has it no longer", spec_.noun), std::string(removed->remedy));
    const auto refuse_here = [&](const std::vector<CaseKind>& others) {
      fail_at(value, fmt::format("{} does not apply to {}", name, to_string(spec_.kind)),
              fmt::format("it is for {}", joined(others, [](CaseKind kind) { return to_string(kind); })), "Remove it");
    };
    for (const KeySpec& key : spec_.others)
      if (key.table == path && key.name == name) refuse_here(key.kinds);
    if (spec_.kinds_with != nullptr)
      if (const auto others = spec_.kinds_with(key_path(path, name)); !others.empty()) refuse_here(others);
    const std::vector<std::string> here = names_below(path, table);
    std::string remedy = fmt::format("Known here: {}", joined(here));
    const std::vector<const KeySpec*> elsewhere = keys_elsewhere([&](const KeySpec& key) { return key.name == name; });
    if (const auto meant = nearest(name, here)) {
      remedy = fmt::format("Did you mean '{}'?", *meant);
    } else if (!elsewhere.empty()) {
      remedy = place_of(elsewhere, value.line == 0);
    } else if (const auto similar = nearest(name, names_in(spec_.keys))) {
      const auto paths = keys_elsewhere([&](const KeySpec& key) { return key.name == *similar; });
      remedy = fmt::format("Did you mean {}?", listed_paths(paths));
    }
    const bool as_table = value.is_table() || is_list_of_tables(value);
    fail_at(value, as_table ? "unknown table" : "unknown key", fmt::format("the {} is strict", spec_.noun), remedy);
  }

  void check_inner_table(const std::string& path, const TomlValue& outer, TomlValue& value, const TableSpec& spec) {
    const std::string& full = spec.name;
    if (!applies(path, outer, spec))
      fail_at(value, "this table does not apply here",
              fmt::format("it is for {} = {}", spec.when_key, joined(spec.when)), "Remove it");
    if (spec.repeated) {
      if (!value.is_array())
        fail_at(value, fmt::format("this is {}", value.is_table() ? "a single table" : value.type_name()),
                "there may be several, each with its own heading", fmt::format("Write [[{}]] above each", full));
      for (TomlValue& item : value.items) {
        if (!item.is_table())
          fail_at(item, fmt::format("{} is {}", item.shown(), item.type_name()), "a table is needed",
                  fmt::format("Write [[{}]] and its keys below", full));
        check_table(spec, item);
      }
      return;
    }
    if (!value.is_table())
      fail_at(value,
              is_list_of_tables(value) ? fmt::format("[[{}]] is a list of tables", full)
                                       : fmt::format("{} is {}", value.shown(), value.type_name()),
              "one table is needed", fmt::format("Write [{}] and its keys below", full));
    check_table(spec, value);
  }

  void check_table(const TableSpec& spec, TomlValue& table) {
    const std::string& path = spec.name;
    for (auto& [name, value] : table.entries) {
      if (const TableSpec* inner = spec_.table(key_path(path, name))) {
        check_inner_table(path, table, value, *inner);
        continue;
      }
      const KeySpec* key = spec_.key(path, name);
      if (key == nullptr) fail_unknown(path, table, name, value);
      if (!applies(path, table, *key)) fail_not_applying(table, *key, value);
      check_value(value, *key);
    }
    for (const KeySpec& key : spec_.keys) {
      if (path != key.table || !applies(path, table, key)) continue;
      for (const KeyRelation& relation : key.relations) check_relation(table, key, relation);
    }
    visitor_.table(spec);
    for (const KeySpec& key : spec_.keys)
      if (path == key.table) complete_and_visit(table, key);
  }

  [[noreturn]] void fail_not_applying(const TomlValue& table, const KeySpec& key, const TomlValue& value) const {
    const std::string chosen = selected(key.table, table, key.when_key);
    fail_at(value,
            chosen.empty() ? "this key does not apply here"
                           : fmt::format("this key does not apply to {} = \"{}\"", key.when_key, chosen),
            fmt::format("it is for {}", joined(key.when)), fmt::format("Remove it, or change {}", key.when_key));
  }

  [[nodiscard]] bool is_automatic(const std::string& path, const TomlEntry& entry) const {
    const KeySpec* key = spec_.key(path, entry.name);
    return key != nullptr && key->type == KeyType::number_or_auto && entry.value.text == "auto";
  }

  void check_relation(const TomlValue& table, const KeySpec& key, const KeyRelation& relation) const {
    using Kind = KeyRelation::Kind;
    std::vector<std::string> names{key.name};
    for (const std::string& other : relation.others) {
      const KeySpec* beside = spec_.key(key.table, other);
      const TableSpec* below = spec_.table(key_path(key.table, other));
      if ((beside != nullptr && applies(key.table, table, *beside)) ||
          (below != nullptr && applies(key.table, table, *below)))
        names.push_back(other);
    }
    std::vector<const TomlEntry*> given;
    for (const TomlEntry& entry : table.entries)
      if (contains(names, entry.name) && !is_automatic(key.table, entry)) given.push_back(&entry);
    if (relation.kind == Kind::only_with) {
      const TomlValue* alone = table.find(key.name);
      if (alone == nullptr || given.size() != 1) return;
      names.erase(names.begin());
      const std::string needed = listed(names.empty() ? relation.others : names, " or ");
      fail_at(*alone, fmt::format("{} is given without {}", key.name, needed), relation.why,
              fmt::format("Add {} = ... to {}", needed, spec_.table(key.table)->heading()));
    }
    if (given.empty() && relation.kind == Kind::exactly_one) {
      if (names.size() == 1) fail_missing(table, key);
      const std::string none =
          names.size() == 2 ? fmt::format("neither {} nor {}", names[0], names[1]) : "none of " + listed(names);
      fail_at(table, none + " is given", relation.why, "Give one of them");
    }
    if (given.size() < 2) return;
    const TomlEntry &first = *given[0], &second = *given[1];
    const bool by_option = second.value.line == 0 && !spec_.table(key.table)->repeated;
    fail_at(second.value, fmt::format("{} and {} are both given", first.name, second.name), relation.why,
            by_option ? fmt::format("Remove one of them: --set {}=none", key_path(key.table, first.name))
                      : "Remove one of them");
  }

  void complete_and_visit(TomlValue& table, const KeySpec& key) const {
    TomlValue* value = table.find(key.name);
    if (value == nullptr) {
      if (!(key.is_required() || key.has_default()) || !applies(key.table, table, key)) return;
      if (key.is_required()) fail_missing(table, key);
      value = &table.entries.emplace_back(TomlEntry{key.name, default_of(key)}).value;
      value->source = table.source;
      value->line = table.line;
      value->path = key.path();
    }
    visitor_.key(key, *value);
  }

  TomlValue& root_;
  const FileSpec& spec_;
  const Visitor& visitor_;
};

}  // namespace

void check_and_complete(TomlValue& root, const FileSpec& spec, const Visitor& visitor) {
  Checker(root, spec, visitor).run();
}

}  // namespace equidem::casefile
