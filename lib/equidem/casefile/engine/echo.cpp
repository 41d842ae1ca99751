// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/casefile/engine/echo.hpp"

#include <algorithm>
#include <utility>

namespace equidem {
namespace {

namespace fs = std::filesystem;

bool is_list_of_tables(const TomlValue& value) {
  return value.is_array() && !value.items.empty() && value.items[0].is_table();
}

std::string literal(const TomlValue& value) {
  switch (value.type) {
    case TomlValue::Type::text:
      return toml_text(value.text);
    case TomlValue::Type::real:
      return toml_number(value.real);
    case TomlValue::Type::array: {
      std::string text = "[";
      for (std::size_t k = 0; k < value.items.size(); ++k) text += (k > 0 ? ", " : "") + literal(value.items[k]);
      return text + "]";
    }
    default:
      return value.shown();
  }
}

void write_table(std::string& out, const std::string& path, const TomlValue& table) {
  for (const auto& [name, value] : table.entries) {
    if (value.is_table() || is_list_of_tables(value) || (value.is_array() && value.items.empty())) continue;
    out += name + " = " + literal(value) + "\n";
  }
  for (const auto& [name, value] : table.entries) {
    const std::string full = path.empty() ? name : path + "." + name;
    if (value.is_table() && !value.entries.empty()) {
      out += "\n[" + full + "]\n";
      write_table(out, full, value);
    } else if (is_list_of_tables(value)) {
      for (const TomlValue& item : value.items) {
        out += "\n[[" + full + "]]\n";
        write_table(out, full, item);
      }
    }
  }
}

void make_relative(TomlValue& value, const fs::path& folder) {
  for (TomlValue& item : value.items) make_relative(item, folder);
  for (auto& [name, entry] : value.entries) make_relative(entry, folder);
  if (!value.is_path) return;
  std::error_code failed;
  const fs::path from = fs::absolute(folder, failed).lexically_normal();
  const fs::path to = fs::absolute(value.text, failed).lexically_normal();
  const fs::path relative = to.lexically_relative(from);
  value.text = relative.empty() ? to.string() : relative.string();
}

}  // namespace

std::string to_toml(TomlValue document, const fs::path& folder) {
  make_relative(document, folder);
  const auto place = [](const auto& entry) { return entry.first == "schema" ? 0 : entry.first == "title" ? 1 : 2; };
  std::stable_sort(document.entries.begin(), document.entries.end(),
                   [&](const auto& a, const auto& b) { return place(a) < place(b); });
  std::string out;
  write_table(out, "", document);
  return out;
}

}  // namespace equidem
