// SPDX-License-Identifier: GPL-3.0-or-later
#include "tables.hpp"

#include <algorithm>

namespace equidem {
namespace {

/// Characters of UTF-8 text.
std::size_t length_of(const std::string& text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](unsigned char c) { return (c & 0xC0) != 0x80; }));
}

}  // namespace

std::string TextTable::text() const {
  std::vector<std::size_t> widths;
  for (const auto& row : rows_) {
    widths.resize(std::max(widths.size(), row.size()));
    for (std::size_t k = 0; k < row.size(); ++k) widths[k] = std::max(widths[k], length_of(row[k]));
  }
  std::string text;
  for (const auto& row : rows_) {
    for (std::size_t k = 0; k < row.size(); ++k) {
      const std::string blanks(widths[k] - length_of(row[k]), ' ');
      text += "  " + (k == 0 ? row[k] + blanks : blanks + row[k]);
    }
    text.erase(text.find_last_not_of(' ') + 1);
    text += "\n";
  }
  return text;
}

std::vector<Results> rows_of(const Table& table, const std::map<std::string, std::string>& renamed) {
  std::vector<Results> rows(table.rows());
  for (const Table::Column& column : table.columns()) {
    const auto name = renamed.find(column.name);
    const std::string& key = name == renamed.end() ? column.name : name->second;
    std::visit(
        [&](const auto& values) {
          for (std::size_t r = 0; r < rows.size(); ++r) rows[r].set(key, values[r]);
        },
        column.values);
  }
  return rows;
}

}  // namespace equidem
