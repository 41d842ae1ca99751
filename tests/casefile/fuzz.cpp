// SPDX-License-Identifier: GPL-3.0-or-later
#include <string>

#include "equidem/casefile/assembly/case.hpp"
#include "equidem/core/random.hpp"

#include "example.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

/// Either a case that writes and reads back, or an Error in one line that names the file.
void check_promise(const std::string& text) {
  try {
    const Case accepted = parsed(text);
    const std::string echoed = to_toml(accepted, ".");
    if (to_toml(parsed(echoed), ".") == echoed) return;
    CAPTURE(text, echoed);
    FAIL_CHECK("the accepted case does not read back");
  } catch (const Error& error) {
    const std::string sentence = error.what();
    if (sentence.starts_with("a.toml") && error.kind() == ErrorKind::bad_input &&
        sentence.find('\n') == std::string::npos)
      return;
    CAPTURE(text, sentence);
    FAIL_CHECK("the error does not say where");
  }
}

}  // namespace

TEST_CASE("a_truncated_case_is_refused_or_valid") {
  for (const std::string& whole : example_cases)
    for (std::size_t length = 0; length <= whole.size(); ++length) check_promise(whole.substr(0, length));
}

TEST_CASE("a_case_with_any_byte_changed_is_refused_or_valid") {
  Random random(1);
  for (const std::string& whole : example_cases) {
    for (std::size_t at = 0; at < whole.size(); ++at) {
      for (int round = 0; round < 4; ++round) {
        std::string text = whole;
        switch (round) {
          case 0:
            text[at] = static_cast<char>(random.below(256));
            break;
          case 1:
            text[at] = "\"[]{}=.,#\n\\-0e'"[random.below(15)];
            break;
          case 2:
            text.erase(at, 1 + random.below(3));
            break;
          default:
            text.insert(at, whole.substr(random.below(whole.size()), random.below(12)));
            break;
        }
        check_promise(text);
      }
    }
  }
}

TEST_CASE("deep_and_long_documents_are_refused_or_valid") {
  check_promise("schema = \"equidem/1\"\nx = " + std::string(100000, '['));
  check_promise("schema = \"equidem/1\"\n" + std::string(100000, 'a') + " = 1\n");
  check_promise("schema = \"equidem/1\"\n[assembly]\nkind = \"" + std::string(100000, 'h') + "\"\n");
  check_promise(std::string(1000, '\0'));
  check_promise("\xef\xbb\xbf" + tension_case);
  check_promise("\xff\xfe");
}
