// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Texts for people.
#include "equidem/core/text.hpp"

#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "support/catch.hpp"

using namespace equidem;

TEST_CASE("digits_are_grouped_by_three_from_the_right") {
  const auto [value, text] = GENERATE(
      table<std::int64_t, std::string>({{0, "0"},
                                        {7, "7"},
                                        {999, "999"},
                                        {1000, "1 000"},
                                        {12345, "12 345"},
                                        {123456, "123 456"},
                                        {1293000, "1 293 000"},
                                        {-999, "-999"},
                                        {-1000, "-1 000"},
                                        {-123456, "-123 456"},
                                        {std::numeric_limits<std::int64_t>::max(), "9 223 372 036 854 775 807"}}));
  CHECK(grouped(value) == text);
}

TEST_CASE("bytes_and_shares_are_rounded_as_a_person_reads_them") {
  for (const auto& [bytes, text] : std::vector<std::pair<double, std::string>>{
           {0, "0 B"}, {999, "999 B"}, {1500, "1.5 kB"}, {9960, "10 kB"}, {999600, "1.0 MB"}, {5.7e9, "5.7 GB"}})
    CHECK(readable_bytes(bytes) == text);
  CHECK(percent(0.0125) == "1.25 %");
  CHECK(percent(0.333333, 2) == "33 %");
}

TEST_CASE("lists_of_words_are_joined_and_shortened") {
  CHECK(joined({"a", "b", "c"}) == "a, b, c");
  CHECK(listed({"a"}) == "a");
  CHECK(listed({"a", "b", "c"}) == "a, b and c");
  CHECK(listed({"a", "b"}, " or ") == "a or b");
  std::vector<std::string> words;
  for (int k = 0; k < 12; ++k) words.push_back(std::to_string(k));
  CHECK(first_words(words) == "0, 1, 2, 3, 4, 5, 6, 7, 8, 9, ..., 12 in all");
  words.resize(10);
  CHECK(first_words(words) == "0, 1, 2, 3, 4, 5, 6, 7, 8, 9");
}

TEST_CASE("long_words_lose_their_middle_and_no_character_is_cut") {
  const std::string word(300, 'x');
  CHECK(with_short_words("a " + word + " b").size() < 100);
  CHECK(with_short_words("a " + word + " b").starts_with("a xxx"));
  std::string umlauts;
  for (int k = 0; k < 150; ++k) umlauts += "ä";
  for (const std::string& text : {umlauts, "x" + umlauts}) {
    CHECK_FALSE(place_of_wrong_byte(with_short_words(text)));
    CHECK(with_short_words(text).find("...") != std::string::npos);
  }
  CHECK(with_short_words("short words stay") == "short words stay");
}

TEST_CASE("bytes_that_are_no_character_are_found") {
  CHECK_FALSE(place_of_wrong_byte("abc äöü 円"));
  CHECK(place_of_wrong_byte("abc\xff") == 3);
  CHECK(place_of_wrong_byte("ab\xc3") == 2);
  CHECK(columns_of("äb円") == 3);
}
