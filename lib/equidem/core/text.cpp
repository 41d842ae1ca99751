// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/core/text.hpp"

#include <algorithm>

#include "equidem/core/error.hpp"

namespace equidem {

std::string joined(const std::vector<std::string>& words, std::string_view separator) {
  std::string text;
  for (const std::string& word : words) text.append(&word == words.data() ? "" : separator).append(word);
  return text;
}

bool has_controls(std::string_view text) {
  for (std::size_t k = 0; k < text.size(); ++k) {
    const auto byte = static_cast<unsigned char>(text[k]);
    if ((byte < ' ' && byte != '\t' && byte != '\n' && byte != '\r') || byte == 0x7f) return true;
    const auto next = static_cast<unsigned char>(k + 1 < text.size() ? text[k + 1] : 0);
    if (byte == 0xc2 && next >= 0x80 && next < 0xa0) return true;  // U+0080 to U+009F
  }
  return false;
}

std::string first_words(std::vector<std::string> words) {
  constexpr std::size_t most = 10;
  const auto count = std::ssize(words);
  if (words.size() <= most) return joined(words);
  words.resize(most);
  return fmt::format("{}, ..., {} in all", joined(words), grouped(count));
}

std::string listed(std::vector<std::string> words, std::string_view last) {
  if (words.size() < 2) return joined(words);
  const std::string end = words.back();
  words.pop_back();
  return joined(words).append(last).append(end);
}

std::vector<std::string_view> parts_of(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  for (std::size_t end = text.find(separator); end != std::string_view::npos; end = text.find(separator)) {
    parts.push_back(trimmed(text.substr(0, end)));
    text.remove_prefix(end + 1);
  }
  parts.push_back(trimmed(text));
  return parts;
}

std::string with_short_words(std::string_view text) {
  constexpr std::size_t longest = 200, first = 40, last = 17;
  const auto inside_character = [&](std::size_t at) { return (static_cast<unsigned char>(text[at]) & 0xC0) == 0x80; };
  std::string result;
  for (std::size_t begin = 0, end = 0; begin <= text.size(); begin = end + 1) {
    end = std::min(text.find(' ', begin), text.size());
    std::size_t head = end, tail = end;
    if (end - begin > longest) {
      for (head = begin + first; head > begin && inside_character(head);) --head;
      for (tail = end - last; tail < end && inside_character(tail);) ++tail;
    }
    result.append(text.substr(begin, head - begin))
        .append(head < tail ? "..." : "")
        .append(text.substr(tail, end - tail));
    if (end < text.size()) result += ' ';
  }
  return result;
}

std::string grouped(std::int64_t value) {
  std::string digits = fmt::format("{}", value);
  for (auto k = static_cast<std::ptrdiff_t>(digits.size()) - 3; k > (value < 0 ? 1 : 0); k -= 3)
    digits.insert(static_cast<std::size_t>(k), 1, ' ');
  return digits;
}

std::string percent(double share, int digits) {
  return fmt::format("{:.{}g} %", 100 * share, digits);
}

std::string readable_bytes(double bytes) {
  const char* units[] = {"B", "kB", "MB", "GB", "TB"};
  int unit = 0;
  // The bounds are those of the rounded number: never "1000 kB" or "10.0 kB".
  while (bytes >= 999.5 && unit < 4) {
    bytes /= 1000;
    ++unit;
  }
  return fmt::format("{:.{}f} {}", bytes, bytes < 9.95 && unit > 0 ? 1 : 0, units[unit]);
}

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view blanks = " \t\r";
  const std::size_t first = text.find_first_not_of(blanks);
  return first == std::string_view::npos ? "" : text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

std::string_view without_byte_order_mark(std::string_view text) {
  return text.starts_with("\xEF\xBB\xBF") ? text.substr(3) : text;
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

std::optional<std::size_t> place_of_wrong_byte(std::string_view text) {
  for (std::size_t k = 0; k < text.size();) {
    const auto byte = [&](std::size_t at) { return at < text.size() ? static_cast<unsigned char>(text[at]) : 0U; };
    if (static_cast<unsigned char>(text[k]) < 0x80) {
      ++k;
      continue;
    }
    const unsigned first = byte(k), second = byte(k + 1);
    const std::size_t length = first < 0xC2 ? 0 : first < 0xE0 ? 2 : first < 0xF0 ? 3 : first < 0xF5 ? 4 : 0;
    bool good = length > 0;
    for (std::size_t more = 1; more < length; ++more) good = good && (byte(k + more) & 0xC0U) == 0x80U;
    // Overlong forms, halves of pairs of UTF-16, and what lies above U+10FFFF.
    good = good && !(first == 0xE0 && second < 0xA0) && !(first == 0xED && second >= 0xA0) &&
           !(first == 0xF0 && second < 0x90) && !(first == 0xF4 && second >= 0x90);
    if (!good) return k;
    k += length;
  }
  return {};
}

void refuse_utf16(std::string_view text, const std::string& name) {
  using namespace std::string_view_literals;
  const auto zero = [&](std::size_t byte) { return text[byte] == 0; };
  const bool four = text.size() > 3;
  const bool of_32 = four && (text.starts_with("\xFF\xFE\0\0"sv) || text.starts_with("\0\0\xFE\xFF"sv) ||
                              (zero(1) && zero(2) && zero(0) != zero(3)));
  const bool of_16 = text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF") ||
                     (four && zero(0) == zero(2) && zero(1) == zero(3) && zero(0) != zero(1));
  if (!of_32 && !of_16) return;
  bad_input_at(name.empty() ? "line 1" : name + ":1", fmt::format("the text is UTF-{}, not UTF-8", of_32 ? 32 : 16),
               fmt::format("byte 1 of the line is 0x{:02x}", static_cast<unsigned char>(text[0])),
               "Save the file as UTF-8 (in spreadsheets: CSV UTF-8)");
}

bool is_plain_name(std::string_view text) {
  return std::ranges::all_of(text, [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
  });
}

std::size_t columns_of(std::string_view text) {
  const auto continues = [](char c) { return (static_cast<unsigned char>(c) & 0xC0) == 0x80; };
  return text.size() - static_cast<std::size_t>(std::ranges::count_if(text, continues));
}

}  // namespace equidem
