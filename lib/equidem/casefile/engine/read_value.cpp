// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/casefile/engine/read_value.hpp"

namespace equidem::casefile {

const std::vector<TomlValue>& repeated(const TomlValue& root, const char* name) {
  static const std::vector<TomlValue> none;
  const TomlValue* list = root.find(name);
  return list == nullptr ? none : list->items;
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

void check_plain_name(const TomlValue& value, const std::string& key, const std::string& what, const std::string& use) {
  if (is_plain_name(value.text)) return;
  fail_at(value, key, fmt::format("{} cannot name {}", value.shown(), what), use,
          "Use letters, digits, '_' and '-' only");
}

}  // namespace equidem::casefile
