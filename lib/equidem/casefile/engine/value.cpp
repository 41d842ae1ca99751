// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/casefile/engine/value.hpp"

#include <map>
#include <string_view>

namespace equidem::casefile {

double number_of(const TomlValue& value) {
  if (value.type == TomlValue::Type::boolean) return 0;
  return bytes_of(value).value_or(0);
}

std::filesystem::path path_of(TomlValue& value, const std::filesystem::path& folder) {
  const std::filesystem::path path = opened(value.text, folder);
  value.text = path.string();
  value.is_path = true;
  return path;
}

const std::vector<TomlValue>& repeated(const TomlValue& root, const char* name) {
  static const std::vector<TomlValue> none;
  const TomlValue* list = root.find(name);
  return list == nullptr ? none : list->items;
}

std::filesystem::path opened(const std::filesystem::path& written, const std::filesystem::path& folder) {
  return (written.is_absolute() ? written : folder / written).lexically_normal();
}

void check_names(const TomlValue& root, const char* list, const std::string& prefix) {
  const std::string key = fmt::format("{}{}.name", prefix, list);
  std::map<std::string_view, const TomlValue*> known;
  for (const TomlValue& table : repeated(root, list)) {
    const TomlValue& name = *table.find("name");
    if (name.text.empty()) fail_at(name, key, "the name is empty", fmt::format("a name means one {}", list), "Name it");
    if (const auto [other, is_new] = known.try_emplace(name.text, &table); !is_new)
      fail_at(name, key, fmt::format("there are two {}s '{}'", list, name.text),
              fmt::format("the other is at {}", other->second->where()), "Give each its own name");
  }
}

void check_plain_name(const TomlValue& value, const std::string& key, const std::string& what, const std::string& use) {
  if (is_plain_name(value.text)) return;
  fail_at(value, key, fmt::format("{} cannot name {}", value.shown(), what), use,
          "Use letters, digits, '_' and '-' only");
}

void check_box(const TomlValue& given, const std::string& key, Vec2 low, Vec2 high) {
  if (low.x >= high.x || low.y >= high.y)
    fail_at(given, key, fmt::format("the box {} is empty", given.shown()), "it is [x_min, y_min, x_max, y_max]",
            "Put the smaller numbers first");
}

}  // namespace equidem::casefile
