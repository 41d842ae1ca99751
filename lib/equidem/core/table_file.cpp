// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/core/table_file.hpp"

#include <algorithm>
#include <utility>

#include "equidem/core/error.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

/// The text before the separator, trimmed; it and the separator are taken off `rest`.
std::string_view next_part(std::string_view& rest, char separator) {
  const std::size_t end = std::min(rest.find(separator), rest.size());
  const std::string_view part = trimmed(rest.substr(0, end));
  rest.remove_prefix(std::min(end + 1, rest.size()));
  return part;
}

}  // namespace

TableFile::TableFile(std::filesystem::path path)
    : path_(std::move(path)), content_(read_file(path_)), rest_(without_byte_order_mark(content_)) {}

bool TableFile::next() {
  do {
    if (rest_.empty()) return false;
    row_ = next_part(rest_, '\n');
    ++line_;
  } while (row_.empty() || row_.front() == '#');
  ++count_;
  cells_.clear();
  std::string_view cells = row_;
  for (auto commas = std::ranges::count(row_, ','); commas >= 0; --commas) cells_.push_back(next_part(cells, ','));
  return true;
}

std::string TableFile::where() const {
  return fmt::format("{}:{}", path_.string(), line_);
}

void TableFile::fail(std::string problem, std::string why, std::string remedy) const {
  bad_input_at(where(), std::move(problem), std::move(why), std::move(remedy));
}

}  // namespace equidem
