// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Formatting of text; the only place that includes fmt.
#pragma once

#include <concepts>
#include <cstdint>
#include <functional>
#include <optional>
#include <ranges>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

namespace equidem {

/// "1 disc", "2 discs".
inline std::string counted(long long count, const std::string& singular, const std::string& plural = {}) {
  return fmt::format("{} {}", count, count == 1 ? singular : plural.empty() ? singular + "s" : plural);
}

/// The words with a separator between them.
std::string joined(const std::vector<std::string>& words, std::string_view separator = ", ");
/// The words word_of(element) of the elements of a range, with a separator between them; a member gives them, too.
template <std::ranges::input_range Range, std::invocable<std::ranges::range_reference_t<Range>> WordOf>
std::string joined(Range&& range, const WordOf& word_of, std::string_view separator = ", ") {
  std::vector<std::string> words;
  if constexpr (std::ranges::sized_range<Range>) words.reserve(std::ranges::size(range));
  for (const auto& element : range) words.emplace_back(std::invoke(word_of, element));
  return joined(words, separator);
}

/// "a, b, ..., 300 000 in all": the first ten words, for lists that may be long.
std::string first_words(std::vector<std::string> words);

/// "a, b and c".
std::string listed(std::vector<std::string> words, std::string_view last = " and ");

/// Whether a text in UTF-8 has control characters but for tabs and line breaks: terminals obey them, XML forbids them.
bool has_controls(std::string_view text);

/// The parts of a text between separators, trimmed; one more than there are separators.
std::vector<std::string_view> parts_of(std::string_view text, char separator);

/// The text with "..." in place of the middle of each word of more than 200 bytes, of which 60 stay: messages repeat
/// words of the user's files. UTF-8 characters stay whole.
std::string with_short_words(std::string_view text);

/// The digits in groups of three: "1 293 000".
std::string grouped(std::int64_t value);

/// A share in percent: "1.25 %".
std::string percent(double share, int digits = 3);

/// A number of bytes as a person reads it: "5.7 GB".
std::string readable_bytes(double bytes);

/// Without spaces, tabs and carriage returns at both ends.
std::string_view trimmed(std::string_view text);

/// Without the mark that some programs put before a UTF-8 text.
std::string_view without_byte_order_mark(std::string_view text);

/// The words between blanks: spaces, tabs and carriage returns.
std::vector<std::string_view> words_of(std::string_view line);

/// The first byte that is of no UTF-8 character; none where there is none.
std::optional<std::size_t> place_of_wrong_byte(std::string_view text);

/// \param name of its file
/// \throws Error (bad_input) where the text is of UTF-16 or UTF-32
void refuse_utf16(std::string_view text, const std::string& name);

/// Whether the text consists of letters, digits, '_' and '-' only.
bool is_plain_name(std::string_view text);

/// Number of characters of a UTF-8 text.
std::size_t columns_of(std::string_view text);

}  // namespace equidem
