// SPDX-License-Identifier: GPL-3.0-or-later
#include "csv_cells.hpp"

#include <charconv>
#include <limits>
#include <system_error>
#include <utility>

namespace equidem {
namespace {

template <typename Number>
std::optional<Number> whole_cell(const std::string& cell) {
  Number value = 0;
  const auto [end, problem] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  if (problem != std::errc() || end != cell.data() + cell.size()) return {};
  return value;
}

}  // namespace

std::vector<std::vector<std::string>> csv_cells(const std::string& text) {
  std::vector<std::vector<std::string>> rows;
  std::vector<std::string> row(1);
  bool quoted = false;
  for (std::size_t k = 0; k < text.size(); ++k) {
    const char c = text[k];
    if (quoted) {
      if (c == '"' && k + 1 < text.size() && text[k + 1] == '"') {
        row.back() += '"';
        ++k;
      } else if (c == '"') {
        quoted = false;
      } else {
        row.back() += c;
      }
    } else if (c == '"') {
      quoted = true;
    } else if (c == ',') {
      row.emplace_back();
    } else if (c == '\n') {
      rows.push_back(std::move(row));
      row.assign(1, {});
    } else if (c != '\r') {
      row.back() += c;
    }
  }
  if (row.size() > 1 || !row.front().empty()) rows.push_back(std::move(row));
  return rows;
}

std::optional<double> csv_number(const std::string& cell) {
  return cell.empty() ? std::numeric_limits<double>::quiet_NaN() : whole_cell<double>(cell);
}

std::optional<std::int64_t> csv_integer(const std::string& cell) {
  return whole_cell<std::int64_t>(cell);
}

}  // namespace equidem
