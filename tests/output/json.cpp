// SPDX-License-Identifier: GPL-3.0-or-later
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>

#include "equidem/core/file.hpp"
#include "equidem/core/random.hpp"
#include "equidem/core/text.hpp"
#include "equidem/output/results.hpp"

#include "output/states.hpp"
#include "support/catch.hpp"

using namespace equidem;

namespace {

/// The text after "key": up to the end of its line, without the comma.
std::string value_of(const std::string& json, const std::string& key) {
  const std::string name = fmt::format("\"{}\": ", key);
  const std::size_t start = json.find(name);
  if (start == std::string::npos) return "(missing)";
  const std::size_t from = start + name.size();
  std::string value = json.substr(from, json.find('\n', from) - from);
  if (!value.empty() && value.back() == ',') value.pop_back();
  return value;
}

bool is_json(const std::string& text) {
  const TemporaryFolder folder;
  write_file(folder / "result.json", text, false);
  return run_python("well_formed.py", {(folder / "result.json").string()}) == 0;
}

}  // namespace

TEST_CASE("numbers_in_json_read_back_to_the_same_bits") {
  Random random(11);
  Results object;
  std::vector<double> numbers{0.0, -0.0, 1.0, 1e6, 0.1, 1.0 / 3, 5e-324, 1.7976931348623157e308, 1e16, 123456789012.0};
  while (numbers.size() < 500) {
    const double number = std::bit_cast<double>(random.bits());
    if (std::isfinite(number)) numbers.push_back(number);
  }
  for (std::size_t k = 0; k < numbers.size(); ++k) object.set("n" + std::to_string(k), numbers[k]);
  const std::string text = object.json();

  for (std::size_t k = 0; k < numbers.size(); ++k) {
    const std::string value = value_of(text, "n" + std::to_string(k));
    double back = 1;
    std::from_chars(value.data(), value.data() + value.size(), back);
    CAPTURE(value, numbers[k]);
    CHECK(std::bit_cast<std::uint64_t>(back) == std::bit_cast<std::uint64_t>(numbers[k]));
  }
  CHECK(is_json(text));
}

TEST_CASE("nan_and_infinity_become_null") {
  const double infinity = std::numeric_limits<double>::infinity();
  Results object;
  object.set("a", std::nan("")).set("b", infinity).set("c", -infinity).set("d", Voigt{1, std::nan(""), 2});
  const std::string text = object.json();
  CAPTURE(text);
  CHECK(value_of(text, "a") == "null");
  CHECK(value_of(text, "b") == "null");
  CHECK(value_of(text, "c") == "null");
  CHECK(value_of(text, "d") == "[1, null, 2]");
  CHECK(is_json(text));
}

TEST_CASE("any_text_makes_valid_json") {
  Results object;
  object.set("quote\"key", "line\nbreak, \\ and \"quotes\"");
  object.set("not_utf8", std::string("caf\xe9 \xff\xc3"));
  object.set("list", std::vector<std::string>{"a", "\x01"});
  object.set("nothing", std::vector<double>{}).set("empty", Results()).set("unknown", nullptr);
  object.set("several", std::vector<Results>{Results().set("k", 1), Results().set("k", true)});
  CAPTURE(object.json());
  CHECK(is_json(object.json()));
}

TEST_CASE("keys_keep_their_order_and_the_last_value_counts") {
  Results object;
  object.set("z", 1).set("a", 2).set("z", 3).set("copy", Results(object));
  CHECK(object.json() == "{\n  \"z\": 3,\n  \"a\": 2,\n  \"copy\": {\n    \"z\": 3,\n    \"a\": 2\n  }\n}\n");
}

TEST_CASE("slashes_nest_keys") {
  Results results;
  results.set("nu/plane_strain", 0.25).set("other", Results().set("a", 1)).set("nu/plane_stress", 0.2);
  CHECK(results.json() ==
        "{\n  \"nu\": {\n    \"plane_strain\": 0.25,\n    \"plane_stress\": 0.2\n  },\n  \"other\": {\n    \"a\": "
        "1\n  }\n}\n");
}
