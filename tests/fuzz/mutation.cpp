// SPDX-License-Identifier: GPL-3.0-or-later
#include "mutation.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstddef>
#include <string_view>
#include <utility>

namespace equidem::fuzz {
namespace {

using std::string_view_literals::operator""sv;

constexpr std::size_t most_bytes = 200000;  // of an input

constexpr std::array extremes = {"0"sv,
                                 "-0.0"sv,
                                 "-1"sv,
                                 "1"sv,
                                 "2"sv,
                                 "0.5"sv,
                                 "nan"sv,
                                 "-inf"sv,
                                 "1e308"sv,
                                 "-1e308"sv,
                                 "1e400"sv,
                                 "5e-324"sv,
                                 "1e-310"sv,
                                 "2147483647"sv,
                                 "2147483648"sv,
                                 "4294967296"sv,
                                 "9007199254740993"sv,
                                 "9223372036854775807"sv,
                                 "-9223372036854775808"sv,
                                 "9223372036854775808"sv,
                                 "18446744073709551616"sv,
                                 "1000000000"sv,
                                 "100000"sv,
                                 "0x10"sv,
                                 "1_000"sv,
                                 "1979-05-27T07:32:00Z"sv,
                                 "true"sv,
                                 "false"sv,
                                 "null"sv,
                                 "\"\""sv,
                                 "''"sv,
                                 "[]"sv,
                                 "{}"sv,
                                 "[[]]"sv,
                                 "[1, 2]"sv,
                                 "\"none\""sv,
                                 "\"auto\""sv,
                                 "\"\\u0000\""sv,
                                 "\"..\""sv,
                                 "none"sv,
                                 "# "sv,
                                 ","sv,
                                 ";"sv,
                                 "\n"sv,
                                 "\r\n"sv,
                                 "\t"sv,
                                 "\0"sv,
                                 "\xef\xbb\xbf"sv,
                                 "\xff"sv,
                                 "\xc3\xa9"sv,
                                 "[[grain]]\n"sv,
                                 "[[wall]]\n"sv,
                                 "[run]\n"sv};

/// Where a span of a text begins, and its length.
struct Span {
  std::size_t begin = 0;
  std::size_t length = 0;
};

Span span_of(const std::string& text, Random& random) {
  const std::size_t begin = random.below(text.size() + 1);
  const std::size_t most = std::size_t{1} << random.below(10);
  return {begin, std::min(text.size() - begin, static_cast<std::size_t>(random.below(most + 1)))};
}

/// A number or a word around or behind a random place.
Span word_of(const std::string& text, Random& random) {
  const auto belongs = [&](std::size_t at) {
    const auto c = static_cast<unsigned char>(text[at]);
    return std::isalnum(c) != 0 || c == '.' || c == '-' || c == '+' || c == '_';
  };
  std::size_t begin = random.below(text.size() + 1);
  while (begin < text.size() && !belongs(begin)) ++begin;
  while (begin > 0 && begin < text.size() && belongs(begin - 1)) --begin;
  std::size_t end = begin;
  while (end < text.size() && belongs(end)) ++end;
  return {begin, end - begin};
}

Span line_of(const std::string& text, Random& random) {
  const std::size_t at = random.below(text.size() + 1);
  const std::size_t before = at == 0 ? std::string::npos : text.rfind('\n', at - 1);
  const std::size_t begin = before == std::string::npos ? 0 : before + 1;
  const std::size_t end = std::min(text.find('\n', begin), text.size() - 1);
  return {begin, begin >= text.size() ? 0 : end + 1 - begin};
}

std::string_view extreme(Random& random) {
  return extremes[random.below(extremes.size())];
}

void change(std::string& text, const std::string& other, Random& random) {
  const auto replace = [&](Span span, std::string_view by) { text.replace(span.begin, span.length, by); };
  const auto part = [](const std::string& of, Span span) { return of.substr(span.begin, span.length); };
  switch (random.below(11)) {
    case 0:
      if (!text.empty()) text[random.below(text.size())] ^= static_cast<char>(1U << random.below(8));
      return;
    case 1:
      if (!text.empty()) text[random.below(text.size())] = static_cast<char>(random.below(256));
      return;
    case 2:
      return replace(span_of(text, random), "");
    case 3: {
      const std::string repeated = part(text, span_of(text, random));
      return replace({random.below(text.size() + 1), 0}, repeated);
    }
    case 4: {
      const std::string copied = part(other, span_of(other, random));
      return replace(span_of(text, random), copied);
    }
    case 5: {
      const std::string moved = part(text, line_of(text, random));
      return replace({line_of(text, random).begin, 0}, moved);
    }
    case 6: {
      const std::string copied = part(other, line_of(other, random));
      return replace({line_of(text, random).begin, 0}, copied);
    }
    case 7:
      return replace(line_of(text, random), "");
    case 8:
      return replace({random.below(text.size() + 1), 0}, extreme(random));
    case 9:
      if (random.below(8) == 0) text.resize(random.below(text.size() + 1));
      return;
    default:
      return replace(word_of(text, random), extreme(random));
  }
}

/// A short piece many times over: deep brackets, long words, long lines.
void lengthen(std::string& text, Random& random) {
  constexpr std::array pieces = {"["sv,  "{a="sv, "a."sv,      "9"sv, "\""sv,
                                 "1,"sv, "\n"sv,  "{\"a\":"sv, "x"sv, "[[a]]\n"sv};
  const std::string_view piece = pieces[random.below(pieces.size())];
  std::string many;
  for (std::uint64_t times = random.below(3000); times > 0; --times) many += piece;
  text.insert(random.below(text.size() + 1), many);
}

}  // namespace

std::string mutated(const std::vector<std::string>& seeds, Random& random) {
  std::string text = seeds[random.below(seeds.size())];
  std::uint64_t changes = 1;
  while (changes < 8 && random.below(2) == 0) ++changes;
  for (; changes > 0; --changes) change(text, seeds[random.below(seeds.size())], random);
  if (random.below(100) == 0) lengthen(text, random);
  if (text.size() > most_bytes) text.resize(most_bytes);
  return text;
}

}  // namespace equidem::fuzz
