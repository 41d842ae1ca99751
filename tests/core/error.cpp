// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Errors read as sentences; text helpers; time per stage.
#include "equidem/core/error.hpp"

#include <string>
#include <thread>

#include "equidem/core/stopwatch.hpp"
#include "equidem/core/text.hpp"

#include "support/catch.hpp"

using namespace equidem;

TEST_CASE("an_error_is_a_problem_its_reason_and_a_remedy") {
  const Error whole(ErrorKind::bad_input, "kN is -1 Pa", "it must be positive", "Give a kN above 0 Pa");
  CHECK(std::string(whole.what()) == "kN is -1 Pa (it must be positive). Give a kN above 0 Pa.");
  CHECK(std::string(Error(ErrorKind::interrupted, "stopped as asked", "", "").what()) == "stopped as asked.");
}

TEST_CASE("an_error_gains_the_place_that_caused_it_once") {
  const Error error(ErrorKind::bad_input, "kN is -1 Pa", "", "");
  const Error placed = error.at("case.toml:3: springs.kN");
  CHECK(std::string(placed.what()) == "case.toml:3: springs.kN: kN is -1 Pa.");
  CHECK(placed.where() == "case.toml:3: springs.kN");
  CHECK(std::string(placed.at("elsewhere").what()) == placed.what());
  CHECK(placed.kind() == ErrorKind::bad_input);
  CHECK(placed.problem() == "kN is -1 Pa");
}

TEST_CASE("a_long_word_of_the_user_is_shortened_in_the_sentence_and_kept_beside_it") {
  const std::string key(100000, 'k');
  const Error error(ErrorKind::bad_input, "unknown key '" + key + "'", "", "", key);
  const std::string sentence = error.what();
  CAPTURE(sentence);
  CHECK(sentence == std::string(40, 'k') + "..." + std::string(16, 'k') + ": unknown key '" + std::string(39, 'k') +
                        "..." + std::string(15, 'k') + "'.");
  CHECK(error.where() == key);
  const std::string path = "/" + std::string(198, 'd') + ":";
  CHECK(with_short_words(path + " a  b ") == path + " a  b ");
  CHECK(with_short_words(std::string(300, '\x80')) == "...");
  std::string letters;
  for (int k = 0; k < 200; ++k) letters += "é";
  for (const std::string before : {"", "x"}) {
    const std::string shorter = with_short_words(before + letters);
    CAPTURE(shorter);
    CHECK(columns_of(shorter) >= 30);
    CHECK(columns_of(shorter) - before.size() - 3 == (shorter.size() - before.size() - 3) / 2);
  }
}

TEST_CASE("control_characters_of_the_user_do_not_reach_the_terminal") {
  const Error error(ErrorKind::bad_input, "unknown key 'a\x1b[2J\n\x7f'", "", "");
  CHECK(std::string(error.what()) == "unknown key 'a\\x1b[2J\\x0a\\x7f'.");
}

TEST_CASE("parts_of_a_text_are_one_more_than_its_separators") {
  using Parts = std::vector<std::string_view>;
  CHECK(parts_of("1, ,2", ',') == Parts{"1", "", "2"});
  CHECK(parts_of("", ',') == Parts{""});
  CHECK(parts_of(",", ',') == Parts{"", ""});
}

TEST_CASE("words_are_joined_by_a_separator_and_listed_by_a_last_one") {
  CHECK(joined({}) == "");
  CHECK(joined({"a", "b", "c"}, "; ") == "a; b; c");
  CHECK(joined(std::vector<int>{1, 2}, [](int k) { return fmt::format("{}", k); }) == "1, 2");
  struct Named {
    std::string name;
  };
  CHECK(joined(std::vector<Named>{{"x"}, {"y"}}, &Named::name, "-") == "x-y");
  CHECK(listed({"a", "b", "c"}) == "a, b and c");
  CHECK(listed({"a"}, " or ") == "a");
}

TEST_CASE("the_kind_of_an_error_is_the_exit_code") {
  const auto code_of = [](auto&& thrower) {
    try {
      thrower();
    } catch (const Error& error) {
      return error.exit_code();
    }
    return 0;
  };
  CHECK(code_of([] { bad_input("a", "b", "c"); }) == 2);
  CHECK(code_of([] { computation_failed("a", "b", "c"); }) == 1);
  CHECK(Error(ErrorKind::interrupted, "", "", "").exit_code() == 130);
}

TEST_CASE("bytes_are_written_as_people_read_them") {
  CHECK(readable_bytes(0) == "0 B");
  CHECK(readable_bytes(999) == "999 B");
  CHECK(readable_bytes(1000) == "1.0 kB");
  CHECK(readable_bytes(5.7e9) == "5.7 GB");
  CHECK(readable_bytes(57e6) == "57 MB");
  CHECK(readable_bytes(3e15) == "3000 TB");
}

TEST_CASE("bytes_never_read_as_a_thousand_of_a_unit") {
  CHECK(readable_bytes(999.7e3) == "1.0 MB");
  CHECK(readable_bytes(9.96e3) == "10 kB");
}

TEST_CASE("counted_things_take_their_plural") {
  CHECK(counted(1, "disc") == "1 disc");
  CHECK(counted(0, "disc") == "0 discs");
  CHECK(counted(2, "body", "bodies") == "2 bodies");
}

TEST_CASE("stage_times_add_up_in_the_order_of_first_use") {
  StageTimes times;
  times.add("order", 1);
  times.add("factorize", 2);
  times.add("order", 0.5);
  CHECK(times.of("order") == 1.5);
  CHECK(times.of("solve") == 0);
  CHECK(times.total() == 3.5);
  REQUIRE(times.stages().size() == 2);
  CHECK(times.stages()[0].first == "order");
  CHECK(times.stages()[1].first == "factorize");
}

TEST_CASE("a_lap_starts_the_next_one") {
  Stopwatch watch;
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  const double first = watch.lap();
  const double second = watch.lap();
  CAPTURE(first, second);
  CHECK(first >= 0.02);
  CHECK(second < first);
}

TEST_CASE("progress_of_a_short_computation_says_nothing_and_does_not_stop_it") {
  set_progress_shown(false);
  Progress progress("testing");
  CHECK_NOTHROW(progress.update(0));
  CHECK_NOTHROW(progress.update(1));
  CHECK_NOTHROW(stop_if_interrupted());
  set_progress_shown(true);
}
