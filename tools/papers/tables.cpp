// SPDX-License-Identifier: GPL-3.0-or-later
#include "tables.hpp"

namespace equidem {

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
