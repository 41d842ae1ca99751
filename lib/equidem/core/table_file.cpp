// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/core/table_file.hpp"

#include <algorithm>
#include <utility>

#include "equidem/core/error.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

/// The line at the begin of the text, trimmed; it is taken off.
std::string_view next_line(std::string_view& rest) {
  const std::size_t end = std::min(rest.find('\n'), rest.size());
  const std::string_view line = trimmed(rest.substr(0, end));
  rest.remove_prefix(std::min(end + 1, rest.size()));
  return line;
}

}  // namespace

TableFile::TableFile(std::filesystem::path path)
    : path_(std::move(path)), content_(read_file(path_)), rest_(without_byte_order_mark(content_)) {}

bool TableFile::next() {
  do {
    if (rest_.empty()) return false;
    row_ = next_line(rest_);
    ++line_;
  } while (row_.empty() || row_.front() == '#');
  ++count_;
  cells_ = parts_of(row_, ',');
  return true;
}

std::string TableFile::where() const {
  return fmt::format("{}:{}", path_.string(), line_);
}

void TableFile::fail(std::string problem, std::string why, std::string remedy) const {
  bad_input_at(where(), std::move(problem), std::move(why), std::move(remedy));
}

}  // namespace equidem
