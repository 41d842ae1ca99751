// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <cstdint>

#include "equidem/casefile/engine/keys.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/names.hpp"
#include "equidem/core/text.hpp"

namespace equidem::casefile {
namespace {

std::string key_path(const std::string& path, const std::string& name) {
  return path.empty() ? name : path + "." + name;
}

bool contains(const std::vector<std::string>& words, const std::string& word) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

/// Walks a document beside its table of keys.
class Checker {
 public:
  Checker(TomlValue& root, const FileSpec& spec) : root_(root), spec_(spec) {}

  void run() {
    check_schema();
    check_table("", root_);
    for (const TableSpec& table : spec_.tables) {
      const std::string& name = table.name;
      const std::size_t dot = name.find('.');
      TomlValue* parent = dot == std::string::npos ? &root_ : root_.find(name.substr(0, dot));
      const std::string leaf = dot == std::string::npos ? name : name.substr(dot + 1);
      if (parent == nullptr || parent->find(leaf) != nullptr) continue;
      if (table.required) {
        throw Error(ErrorKind::bad_input, "missing table", fmt::format("it describes {}", table.help),
                    "Add " + table.heading(), fmt::format("{}: {}", root_.where(), table.heading()));
      }
      if (table.completed) {
        TomlValue added;
        added.source = root_.source;
        check_table(table.name, added);
        parent->entries.push_back({leaf, std::move(added)});
      }
    }
  }

 private:
  [[nodiscard]] std::vector<const KeySpec*> key_specs(const std::string& path, const std::string& name) const {
    std::vector<const KeySpec*> found;
    for (const KeySpec& key : spec_.keys)
      if (path == key.table && name == key.name) found.push_back(&key);
    return found;
  }

  [[noreturn]] void fail(const TomlValue& at, const std::string& key, const std::string& problem,
                         const std::string& why, const std::string& remedy) const {
    throw Error(ErrorKind::bad_input, problem, why, remedy, fmt::format("{}: {}", at.where(), key));
  }

  void check_schema() const {
    const TomlValue* schema = root_.find("schema");
    const std::string remedy = fmt::format("Write schema = \"{}\" at the top of the file", spec_.schema);
    if (schema == nullptr)
      fail(root_, "schema", "missing key", fmt::format("every {} names the rules it follows", spec_.noun), remedy);
    if (schema->type == TomlValue::Type::text && schema->text == spec_.schema) return;
    fail(*schema, "schema", fmt::format("{} is not the schema of a {}", schema->shown(), spec_.noun),
         fmt::format("this program reads \"{}\"", spec_.schema), remedy);
  }

  /// The word on which other keys of the table depend, such as the kind of assembly; checked first.
  std::string selector(const std::string& path, const TomlValue& table, const std::string& name) const {
    for (const KeySpec* key : key_specs(path, name)) {
      if (!applies(path, table, key->when_key, key->when)) continue;
      if (const TomlValue* value = table.find(name)) {
        check_value(*value, *key);
        return value->text;
      }
      if (key->is_required()) fail_missing(path, table, *key);
      return parse_toml(fmt::format("value = {}", key->fallback), "").find("value")->text;
    }
    return {};
  }

  bool applies(const std::string& path, const TomlValue& table, const std::string& when_key,
               const std::vector<std::string>& when) const {
    return when_key.empty() || contains(when, selector(path, table, when_key));
  }

  [[noreturn]] void fail_missing(const std::string& path, const TomlValue& table, const KeySpec& key) const {
    const std::string why = fmt::format("{} is needed", expected(key));
    fail(table, key_path(path, key.name), "missing key", why,
         path.empty() ? fmt::format("Add {} = ... at the top of the file", key.name)
                      : fmt::format("Add {} = ... to {}", key.name, bracketed(path)));
  }

  [[nodiscard]] std::string bracketed(const std::string& path) const {
    const TableSpec* table = spec_.table(path);
    return table != nullptr ? table->heading() : fmt::format("[{}]", path);
  }

  [[noreturn]] void fail_unknown(const std::string& path, const TomlValue& table, const std::string& name,
                                 const TomlValue& value) const {
    std::vector<std::string> here;
    for (const KeySpec& key : spec_.keys) {
      if (path == key.table && name == key.former)
        fail(value, key_path(path, name), fmt::format("{} is called {} now", name, key.name),
             "a key has one name for all kinds of bodies", fmt::format("Write {} instead", key.name));
      if (path == key.table && applies(path, table, key.when_key, key.when) && !contains(here, key.name))
        here.emplace_back(key.name);
    }
    const std::string prefix = path.empty() ? "" : path + ".";
    for (const TableSpec& inner : spec_.tables) {
      const std::string& full = inner.name;
      const bool directly_below = full.starts_with(prefix) && full.find('.', prefix.size()) == std::string::npos;
      if (directly_below && !contains(here, full.substr(prefix.size()))) here.push_back(full.substr(prefix.size()));
    }
    std::string remedy = fmt::format("Known here: {}", joined(here));
    if (const auto meant = nearest(name, here)) {
      remedy = fmt::format("Did you mean '{}'?", *meant);
    } else {
      for (const KeySpec& key : spec_.keys) {
        if (name != key.name) continue;
        remedy = key.table.empty() ? "It belongs at the top of the file, before the first [table]"
                                   : fmt::format("It belongs to {}", bracketed(key.table));
        break;
      }
    }
    const bool as_table = value.is_table() || (value.is_array() && !value.items.empty() && value.items[0].is_table());
    fail(value, key_path(path, name), as_table ? "unknown table" : "unknown key",
         fmt::format("the {} is strict", spec_.noun), remedy);
  }

  void check_inner_table(const std::string& path, const TomlValue& outer, TomlValue& value, const TableSpec& spec) {
    const std::string& full = spec.name;
    if (!applies(path, outer, spec.when_key, spec.when)) {
      fail(value, full, "this table does not apply here",
           fmt::format("it is for {} = {}", spec.when_key, joined(spec.when)), "Remove it");
    }
    if (spec.repeated) {
      if (!value.is_array()) {
        fail(value, full, fmt::format("this is {}", value.is_table() ? "a single table" : value.type_name()),
             "there may be several, each with its own heading", fmt::format("Write [[{}]] above each", full));
      }
      for (TomlValue& item : value.items) {
        if (!item.is_table())
          fail(item, full, fmt::format("{} is {}", item.shown(), item.type_name()), "a table is needed",
               fmt::format("Write [[{}]] and its keys below", full));
        check_table(full, item);
      }
      return;
    }
    if (!value.is_table()) {
      const bool heading = value.is_array() && !value.items.empty() && value.items[0].is_table();
      fail(value, full,
           heading ? fmt::format("[[{}]] is a list of tables", full)
                   : fmt::format("{} is {}", value.shown(), value.type_name()),
           "one table is needed", fmt::format("Write [{}] and its keys below", full));
    }
    check_table(full, value);
  }

  void check_table(const std::string& path, TomlValue& table) {
    for (auto& [name, value] : table.entries) {
      const TableSpec* inner = spec_.table(key_path(path, name));
      const auto keys = key_specs(path, name);
      const bool meant_as_key = !keys.empty() && (inner == nullptr || value.type == TomlValue::Type::text);
      if (inner != nullptr && !meant_as_key) {
        check_inner_table(path, table, value, *inner);
        continue;
      }
      if (keys.empty()) fail_unknown(path, table, name, value);
      const auto applying = std::find_if(
          keys.begin(), keys.end(), [&](const KeySpec* key) { return applies(path, table, key->when_key, key->when); });
      if (applying == keys.end()) fail_not_applying(path, table, name, value, keys);
      check_value(value, **applying);
    }
    complete(path, table);
  }

  [[noreturn]] void fail_not_applying(const std::string& path, const TomlValue& table, const std::string& name,
                                      const TomlValue& value, const std::vector<const KeySpec*>& keys) const {
    std::vector<std::string> kinds;
    for (const KeySpec* key : keys) kinds.insert(kinds.end(), key->when.begin(), key->when.end());
    const std::string& selecting = keys.front()->when_key;
    const std::string chosen = selector(path, table, selecting);
    const std::string problem = chosen.empty()
                                    ? fmt::format("this key does not apply here")
                                    : fmt::format("this key does not apply to {} = \"{}\"", selecting, chosen);
    fail(value, key_path(path, name), problem, fmt::format("it is for {}", joined(kinds)),
         fmt::format("Remove it, or change {}", selecting));
  }

  void complete(const std::string& path, TomlValue& table) {
    for (const KeySpec& key : spec_.keys) {
      if (path != key.table || table.find(key.name) != nullptr) continue;
      if (!(key.is_required() || key.has_default()) || !applies(path, table, key.when_key, key.when)) continue;
      if (key.is_required()) fail_missing(path, table, key);
      TomlValue value = *parse_toml(fmt::format("value = {}", key.fallback), "").find("value");
      value.source = table.source;
      value.line = table.line;
      table.entries.push_back({key.name, std::move(value)});
    }
  }

  TomlValue& root_;
  const FileSpec& spec_;
};

}  // namespace

void check_and_complete(TomlValue& root, const FileSpec& spec) {
  Checker(root, spec).run();
}

}  // namespace equidem::casefile
