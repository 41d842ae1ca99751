// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/assembly/import/text_lines.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "equidem/core/error.hpp"
#include "equidem/core/table_file.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

std::string_view without_plus(std::string_view text) {
  return text.size() > 1 && text.front() == '+' && text[1] != '-' ? text.substr(1) : text;
}

}  // namespace

bool TextLines::next() {
  if (rest_.empty()) return false;
  const std::size_t end = std::min(rest_.find_first_of("\r\n"), rest_.size());
  line_ = trimmed(rest_.substr(0, end));
  is_whole_ = end < rest_.size();
  rest_.remove_prefix(end);
  rest_.remove_prefix(rest_.starts_with("\r\n") ? 2 : std::min<std::size_t>(1, rest_.size()));
  ++number_;
  return true;
}

void TextLines::fail(std::string problem, std::string why, std::string remedy) const {
  bad_input_at(fmt::format("line {}", number_), std::move(problem), std::move(why), std::move(remedy));
}

double finite_number(std::string_view text, std::string_view column, int line) {
  const auto value = number_from<double>(without_plus(text));
  if (value && std::isfinite(*value)) return *value;
  bad_input_at(fmt::format("line {}", line), fmt::format("'{}' is no {}", text, column), "a finite number is needed",
               "Correct it");
}

std::int64_t whole_number(std::string_view text, std::string_view column, int line) {
  if (const auto value = number_from<std::int64_t>(without_plus(text))) return *value;
  bad_input_at(fmt::format("line {}", line), fmt::format("'{}' is no {}", text, column), "a whole number is needed",
               "Correct it");
}

}  // namespace equidem
