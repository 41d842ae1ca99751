// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/output/files/json.hpp"

#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>

#include "equidem/core/file.hpp"
#include "equidem/core/random.hpp"
#include "equidem/core/text.hpp"

#include "output/states.hpp"
#include "support/catch.hpp"

using namespace equidem;

namespace {

/// The text that stands behind "key": up to the end of its line, without a comma.
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
  JsonObject object;
  std::vector<double> numbers{0.0, -0.0, 1.0, 1e6, 0.1, 1.0 / 3, 5e-324, 1.7976931348623157e308, 1e16, 123456789012.0};
  while (numbers.size() < 500) {
    const double number = std::bit_cast<double>(random.bits());
    if (std::isfinite(number)) numbers.push_back(number);
  }
  for (std::size_t k = 0; k < numbers.size(); ++k) object.set("n" + std::to_string(k), numbers[k]);
  const std::string text = object.text();

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
  JsonObject object;
  object.set("a", std::nan("")).set("b", infinity).set("c", -infinity).set("d", Voigt{1, std::nan(""), 2});
  const std::string text = object.text();
  CAPTURE(text);
  CHECK(value_of(text, "a") == "null");
  CHECK(value_of(text, "b") == "null");
  CHECK(value_of(text, "c") == "null");
  CHECK(value_of(text, "d") == "[1, null, 2]");
  CHECK(is_json(text));
}

TEST_CASE("any_text_makes_valid_json") {
  JsonObject object;
  object.set("quote\"key", "line\nbreak, \\ and \"quotes\"");
  object.set("not_utf8", std::string("caf\xe9 \xff\xc3"));
  object.set("list", std::vector<std::string>{"a", "\x01"});
  object.set("nothing", std::vector<double>{}).set("empty", JsonObject()).set_null("unknown");
  object.set("several", std::vector<JsonObject>{JsonObject().set("k", 1), JsonObject().set("k", true)});
  CAPTURE(object.text());
  CHECK(is_json(object.text()));
}

TEST_CASE("keys_keep_their_order_and_the_last_value_counts") {
  JsonObject object;
  object.set("z", 1).set("a", 2).set("z", 3).set("copy", JsonObject(object));
  CHECK(object.text() == "{\n  \"z\": 3,\n  \"a\": 2,\n  \"copy\": {\n    \"z\": 3,\n    \"a\": 2\n  }\n}\n");
  CHECK(object.contains("a"));
  CHECK_FALSE(object.contains("b"));
}

TEST_CASE("solve_json_has_the_promised_keys") {
  Equilibrium equilibrium;
  equilibrium.unknowns = 1234;
  equilibrium.relative_residual = 3e-15;
  equilibrium.negative_pivots = 7;
  equilibrium.solver = "made up";
  Effects effects;
  effects.entries = {{"normal springs", true, ""}, {"rotation", false, "kT = 0 everywhere"}};
  StageTimes times;
  times.add("factorize", 0.25);
  const TensionTest test{.stress = 1e6, .gauge = GaugePlacement::quarter};
  TensionSetup setup;
  setup.horizontal = {3, 9};
  setup.height = 0.18;
  TensionResult tension;
  tension.poisson_ratio = 0.125;
  tension.stress = {1e6, 0, 0};

  JsonObject object = solve_json("done", "all is well", times, effects, equilibrium);
  add_tension(object, test, setup, tension);
  const std::string text = object.text();
  CAPTURE(text);
  for (const char* key : {"status",
                          "report",
                          "times",
                          "effects",
                          "version",
                          "unknowns",
                          "relative_residual",
                          "negative_pivots",
                          "unstable_modes",
                          "refinements",
                          "pivot_growth",
                          "factor_nonzeros",
                          "factor_bytes",
                          "solver",
                          "energy",
                          "poisson_ratio",
                          "stiffness_ratio",
                          "strain",
                          "stress",
                          "fitted_poisson_ratio",
                          "height",
                          "gauge"}) {
    CAPTURE(key);
    CHECK(object.contains(key));
  }
  CHECK(value_of(text, "unknowns") == "1234");
  CHECK(value_of(text, "relative_residual") == "3e-15");
  CHECK(value_of(text, "factorize") == "0.25");
  CHECK(value_of(text, "rotation") == "\"kT = 0 everywhere\"");
  CHECK(value_of(text, "stress") == "[1000000, 0, 0]");
  CHECK(value_of(text, "placement") == "\"quarter\"");
  CHECK(value_of(text, "horizontal") == "[3, 9]");
  CHECK(value_of(text, "version") == fmt::format("\"{}\"", library_version()));
  CHECK(is_json(text));
}
