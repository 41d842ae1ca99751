// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/casefile/engine/read_value.hpp"

#include <algorithm>

namespace equidem::casefile {

const std::vector<TomlValue>& repeated(const TomlValue& root, const char* name) {
  static const std::vector<TomlValue> none;
  const TomlValue* list = root.find(name);
  return list == nullptr ? none : list->items;
}

void check_one_of(const TomlValue& table, const std::string& path, const std::array<const char*, 2>& keys,
                  const std::string& missing, const std::string& why, const std::string& remedy,
                  const std::string& remedy_of_both) {
  const TomlValue *first = table.find(keys[0]), *second = table.find(keys[1]);
  if ((first == nullptr) != (second == nullptr)) return;
  if (first == nullptr) fail_at(table, path, missing, why, remedy);
  fail_at(*second, path, fmt::format("{} and {} are both given", keys[0], keys[1]), why,
          remedy_of_both.empty() ? remedy : remedy_of_both);
}

std::filesystem::path opened(const std::filesystem::path& written, const std::filesystem::path& folder) {
  return (written.is_absolute() ? written : folder / written).lexically_normal();
}

void check_names(const TomlValue& root, const char* list) {
  const std::string key = fmt::format("{}.name", list);
  const std::vector<TomlValue>& tables = repeated(root, list);
  for (std::size_t k = 0; k < tables.size(); ++k) {
    const TomlValue& name = *tables[k].find("name");
    if (name.text.empty()) fail_at(name, key, "the name is empty", fmt::format("a name means one {}", list), "Name it");
    for (std::size_t earlier = 0; earlier < k; ++earlier) {
      if (tables[earlier].find("name")->text != name.text) continue;
      fail_at(name, key, fmt::format("there are two {}s '{}'", list, name.text),
              fmt::format("the other is at {}", tables[earlier].where()), "Give each its own name");
    }
  }
}

bool is_plain_name(std::string_view name) {
  const auto plain = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
  };
  return std::all_of(name.begin(), name.end(), plain);
}

void check_plain_name(const TomlValue& value, const std::string& key, const std::string& what, const std::string& use) {
  if (is_plain_name(value.text)) return;
  fail_at(value, key, fmt::format("{} cannot name {}", value.shown(), what), use,
          "Use letters, digits, '_' and '-' only");
}

}  // namespace equidem::casefile
