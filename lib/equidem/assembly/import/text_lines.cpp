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
  const std::size_t end = std::min(rest_.find('\n'), rest_.size());
  line_ = trimmed(rest_.substr(0, end));
  is_whole_ = end < rest_.size();
  rest_.remove_prefix(std::min(end + 1, rest_.size()));
  ++number_;
  return true;
}

void TextLines::fail(std::string problem, std::string why, std::string remedy) const {
  bad_input_at(fmt::format("line {}", number_), std::move(problem), std::move(why), std::move(remedy));
}

std::vector<std::string_view> words_of(std::string_view line) {
  std::vector<std::string_view> words;
  for (std::size_t begin = line.find_first_not_of(" \t\r"); begin != std::string_view::npos;) {
    const std::size_t end = std::min(line.find_first_of(" \t\r", begin), line.size());
    words.push_back(line.substr(begin, end - begin));
    begin = line.find_first_not_of(" \t\r", end);
  }
  return words;
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
