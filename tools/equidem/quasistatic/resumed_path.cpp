// SPDX-License-Identifier: GPL-3.0-or-later
#include "quasistatic/resumed_path.hpp"

#include <algorithm>
#include <optional>

#include "equidem/casefile/engine/keys.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

#include "run/run_case_text.hpp"

namespace equidem {
namespace {

/// "strength.seed is 1 there and 2 here": the first entry in which two documents differ; none: they are the same.
std::optional<std::string> difference(const std::string& key, const TomlValue* there, const TomlValue* here) {
  if (there == nullptr || here == nullptr)
    return fmt::format("{} is given {} alone", key, there == nullptr ? "here" : "there");
  const auto below = [&](const std::string& name) {
    return difference(key.empty() ? name : key + "." + name, there->find(name), here->find(name));
  };
  if (there->is_table() && here->is_table()) {
    for (const auto* table : {there, here}) {
      for (const TomlEntry& entry : table->entries)
        if (auto found = below(entry.name)) return found;
    }
    return {};
  }
  if (there->is_array() && here->is_array()) {
    for (std::size_t k = 0; k < std::max(there->items.size(), here->items.size()); ++k)
      if (auto found = below(std::to_string(k))) return found;
    return {};
  }
  const bool same = there->type == here->type ? there->integer == here->integer && there->real == here->real &&
                                                    there->boolean == here->boolean && there->text == here->text
                                              : there->is_number() && here->is_number() && there->real == here->real;
  if (same) return {};
  return fmt::format("{} is {} there and {} here", key, there->shown(), here->shown());
}

TomlValue deciding_keys(TomlValue document) {
  erase_keys(document, {"title", "output"});
  if (TomlValue* table = document.find("quasistatic")) {
    erase_keys(*table, {"max_events", "frame_every"});
    if (table->entries.empty()) erase_keys(document, {"quasistatic"});
  }
  return document;
}

}  // namespace

std::string deciding_keys_of_path(const Case& resolved, const std::filesystem::path& folder) {
  return to_toml(deciding_keys(resolved.document), folder);
}

FreeKeysOfPath check_same_path(const std::filesystem::path& there, const Case& resolved) {
  const TomlValue kept = casefile::read_document(there, {});
  const TomlValue old_keys = deciding_keys(kept);
  const TomlValue new_keys =
      deciding_keys(casefile::parse_document(to_toml(resolved, there.parent_path()), "the case", {}));
  if (const auto found = difference("", &old_keys, &new_keys)) {
    bad_input_at(there.string(), "the events there are of another case", *found,
                 "Take the value there, or choose another --out, or leave out --resume and pass --overwrite");
  }
  const auto number = [&](const char* key) {
    const TomlValue& value = value_at(kept, key);
    return value.is_number() ? value.integer : 0;
  };
  return {number("quasistatic.max_events"), number("quasistatic.frame_every")};
}

void check_most_events(const FreeKeysOfPath& before, const Case& resolved, std::int64_t events) {
  const std::int64_t most = resolved.quasistatic.max_events;
  // Where contacts rub several events may come at once, so that there are more than were asked for.
  if (most == 0 || most >= events || most == before.max_events) return;
  bad_input_at(resolved.where("quasistatic.max_events"),
               fmt::format("max_events is {}, and {} are done", most, counted(events, "event")),
               "a path that is resumed goes on, and not back",
               "Raise max_events, or leave out --resume and pass --overwrite");
}

}  // namespace equidem
