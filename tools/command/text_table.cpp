// SPDX-License-Identifier: GPL-3.0-or-later
#include "text_table.hpp"

#include <algorithm>

namespace equidem {
namespace {

std::string blanks(std::size_t width, const std::string& cell) {
  return std::string(width - columns_of(cell), ' ');
}

}  // namespace

void TextTable::add_row(std::string_view cells) {
  constexpr std::string_view separator = " & ";
  std::vector<std::string>& row = rows_.emplace_back();
  while (true) {
    const std::size_t end = cells.find(separator);
    row.emplace_back(cells.substr(0, end));
    if (end == std::string_view::npos) return;
    cells.remove_prefix(end + separator.size());
  }
}

std::vector<std::size_t> TextTable::widths(std::size_t least) const {
  std::vector<std::size_t> widths;
  for (const auto& row : rows_) {
    widths.resize(std::max(widths.size(), row.size()), least);
    for (std::size_t k = 0; k < row.size(); ++k) widths[k] = std::max(widths[k], columns_of(row[k]));
  }
  return widths;
}

std::string TextTable::text() const {
  const std::vector<std::size_t> widths = this->widths(0);
  std::string text;
  for (const auto& row : rows_) {
    for (std::size_t k = 0; k < row.size(); ++k) {
      const std::string padding = blanks(widths[k], row[k]);
      text += "  " + (k == 0 ? row[k] + padding : padding + row[k]);
    }
    text.erase(text.find_last_not_of(' ') + 1);
    text += "\n";
  }
  return text;
}

std::string TextTable::markdown() const {
  const std::vector<std::size_t> widths = this->widths(3);
  std::string text;
  for (const auto& row : rows_) {
    for (std::size_t k = 0; k < widths.size(); ++k) {
      const std::string cell = k < row.size() ? row[k] : "";
      text += "| " + cell + blanks(widths[k], cell) + " ";
    }
    text += "|\n";
    if (&row != &rows_.front()) continue;
    for (const std::size_t width : widths) text += "|" + std::string(width + 2, '-');
    text += "|\n";
  }
  return text;
}

}  // namespace equidem
