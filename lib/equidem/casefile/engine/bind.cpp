// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/casefile/engine/bind.hpp"

#include <algorithm>

#include "equidem/casefile/engine/read_value.hpp"

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

bool applies(const KeySpec& key, const TomlValue& table) {
  if (key.when_key.empty()) return true;
  const TomlValue* selector = table.find(key.when_key);
  return selector != nullptr && std::ranges::find(key.when, selector->text) != key.when.end();
}

TomlValue* find_table(TomlValue& root, std::string_view path) {
  TomlValue* at = &root;
  while (at != nullptr && !path.empty()) {
    const std::size_t dot = std::min(path.find('.'), path.size());
    at = at->find(path.substr(0, dot));
    path.remove_prefix(std::min(dot + 1, path.size()));
  }
  return at;
}

}  // namespace equidem::casefile
