// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Numbers of results: as a report, as JSON, with their meanings and units.
#include "equidem/output/results.hpp"

#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <set>
#include <vector>

#include "equidem/contact/effects.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/random.hpp"
#include "equidem/core/text.hpp"
#include "equidem/output/quantities.hpp"

#include "output/states.hpp"
#include "support/catch.hpp"

using namespace equidem;

namespace {

std::string report_of(double value, const Shown& shown, const std::string& unit = {}) {
  return Results().line("x").add("x", "", value, unit, shown).report();
}

/// Text of the report after the name of the line.
std::string shown(const std::string& report) {
  return report.substr(16, report.size() - 17);
}

}  // namespace

TEST_CASE("one_list_gives_report_and_json") {
  Results results;
  results.line("moduli")
      .add("bulk_modulus_2d", "K =", 1.5e9, "Pa")
      .add("shear_modulus", "G =", 5e8, "Pa")
      .note("; mean over all directions");
  results.set("hidden", true);
  results.line("shown").add("", "only here", 3);
  CHECK(results.report() ==
        "moduli          K = 1.5e+09 Pa, G = 5e+08 Pa; mean over all directions\n"
        "shown           only here 3\n");
  CHECK(results.json() ==
        "{\n  \"bulk_modulus_2d\": 1500000000,\n  \"shear_modulus\": 500000000,\n  \"hidden\": true\n}\n");
}

TEST_CASE("numbers_are_shown_as_their_kind_asks") {
  CHECK(shown(report_of(0.123456789, {.digits = 3})) == "0.123");
  CHECK(shown(report_of(0.5, {Shown::decimals, 3})) == "0.500");
  CHECK(shown(report_of(1.23e-15, {Shown::power, 1})) == "1.2e-15");
  CHECK(shown(report_of(0.0125, {Shown::percent, 3})) == "1.25 %");
  CHECK(shown(report_of(std::acos(-1.0) / 2, {Shown::degrees})) == "90.0°");
  CHECK(shown(report_of(5.7e9, {Shown::bytes}, "in all")) == "5.7 GB in all");
  CHECK(shown(report_of(std::nan(""), {})) == "-");
  CHECK(Results().line("discs").add("", "", 1293000, "disc", {Shown::count}).report() ==
        "discs           1 293 000 discs\n");
  CHECK(Results().line("discs").add("", "", 1, "disc", {Shown::count}).report() == "discs           1 disc\n");
}

TEST_CASE("round_off_beside_the_largest_component_is_zero") {
  const Results results = Results().line("stress").add("stress", "", Voigt{1, 1e-14, -2}, "Pa", {Shown::components});
  CHECK(results.report() == "stress          xx 1, yy 0, xy -2 Pa\n");
  CHECK(results.json() == "{\n  \"stress\": [1, 1e-14, -2]\n}\n");
  const Matrix3 matrix{{{3, 1e-15, 0}, {1e-15, 3, 0}, {0, 0, 1}}};
  const std::string lines = Results().line("stiffness").add("", "", matrix, "Pa").report();
  CAPTURE(lines);
  CHECK(lines.starts_with("stiffness                       3                0                0  Pa\n"));
}

TEST_CASE("a_table_has_a_column_for_each_label") {
  std::vector<Results> rows{Results().add("value", "kT", 0.5).add("status", "status", "solved").set("energy", 2.0),
                            Results().add("value", "kT", 10).add("status", "status", "failed").note("no contacts")};
  Results results;
  results.table("points", rows);
  CHECK(results.report() ==
        " kT  status\n"
        "0.5  solved\n"
        " 10  failed  no contacts\n");
  CHECK(results.json().find("\"energy\": 2") != std::string::npos);
}

TEST_CASE("null_shows_its_reason") {
  const Results results = Results().line("critical").add("critical", "", ResultValue::Null{"none down to kT = -kN"});
  CHECK(results.report() == "critical        none down to kT = -kN\n");
  CHECK(results.json() == "{\n  \"critical\": null\n}\n");
}

TEST_CASE("long_lines_break_beside_the_names") {
  std::string words;
  for (int k = 0; k < 60; ++k) words += "word ";
  const std::string report = Results().line("name", words + "end").report();
  CAPTURE(report);
  CHECK(report.find("\n                word") != std::string::npos);
  std::size_t longest = 0;
  for (std::size_t begin = 0; begin < report.size(); begin = report.find('\n', begin) + 1)
    longest = std::max(longest, report.find('\n', begin) - begin);
  CHECK(longest <= 112);
}

TEST_CASE("effects_are_listed_with_the_reasons_of_the_inactive_ones") {
  Effects effects;
  effects.entries = {{"normal springs", true, ""}, {"rotation", false, "kT = 0 everywhere"}};
  Results results;
  add_effects(results, effects);
  CHECK(results.report() == "effects         normal springs\n                no rotation: kT = 0 everywhere\n");
  CHECK(results.json().find("\"rotation\": \"kT = 0 everywhere\"") != std::string::npos);
}

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

TEST_CASE("the_meaning_of_a_number_is_that_of_its_last_keys") {
  REQUIRE(meaning_of("shear_modulus"));
  CHECK(meaning_of("mean_field/achieved/shear_modulus")->unit == "Pa");
  CHECK(meaning_of("ensemble/3/shear_modulus/mean")->unit == "Pa");
  CHECK(meaning_of("ensemble/shear_modulus/mean")->label == "shear modulus G, mean");
  CHECK(meaning_of("poisson_ratio/plane_strain")->label == "Poisson's ratio nu, plane strain");
  CHECK(meaning_of("density/discs")->unit == "kg/m³");
  CHECK(meaning_of("times/steps")->unit == "s");
  CHECK(meaning_of("steps")->unit.empty());
  CHECK_FALSE(meaning_of("shear_moduli"));
  CHECK_FALSE(meaning_of("my_shear_modulus"));
}

TEST_CASE("units_and_labels_have_an_entry_for_each_number") {
  Results results;
  results.line("moduli").add("shear_modulus", "G =", 5e8, "Pa").add("error_bound", "", 1.0, "Pa for an entry");
  results.set("stress", std::vector{1.0, 2.0, 3.0}).set("unknowns", 12).set("solver", "none").set("complete", true);
  results.set("foreign", 1.0).set("energy/kinetic", 2.0, "J", "energy: kinetic");
  results.table("points", {Results().set("energy", 1.0), Results().set("energy", 2.0).set("height", nullptr)});
  CHECK(units_and_labels(results).json() ==
        "{\n"
        "  \"units\": {\n"
        "    \"shear_modulus\": \"Pa\",\n"
        "    \"error_bound\": \"Pa\",\n"
        "    \"stress\": \"Pa\",\n"
        "    \"unknowns\": \"\",\n"
        "    \"energy.kinetic\": \"J\",\n"
        "    \"points.energy\": \"N\",\n"
        "    \"points.height\": \"m\"\n"
        "  },\n"
        "  \"labels\": {\n"
        "    \"shear_modulus\": \"shear modulus G\",\n"
        "    \"error_bound\": \"bound of the error; of motions relative; absent where none was estimated\",\n"
        "    \"stress\": \"mean stress: xx, yy, xy\",\n"
        "    \"unknowns\": \"number of unknowns\",\n"
        "    \"energy.kinetic\": \"energy: kinetic\",\n"
        "    \"points.energy\": \"strain energy (J per m of depth, per m)\",\n"
        "    \"points.height\": \"height of the block\"\n"
        "  }\n"
        "}\n");
}

TEST_CASE("scalar_numbers_are_those_of_the_json_that_do_not_depend_on_the_machine") {
  Results results;
  results.set("kN", 0.1).set("unknowns", 3).set("stress", std::vector{1.0}).set("height", nullptr);
  results.set("loop_bytes", 8.0).set("kN", 1e9).set("omega_max", std::numeric_limits<double>::infinity());
  results.table("load_cases", {Results().set("energy", 0.3), Results().set("energy", 1e-20)});
  const std::vector<ScalarNumber> numbers = scalar_numbers(results);
  REQUIRE(numbers.size() == 4);
  CHECK(numbers[0].path == "kN");
  CHECK(numbers[0].text == "1000000000");  // the later value
  CHECK(numbers[1].path == "unknowns");
  CHECK(numbers[3].path == "load_cases/1/energy");
  CHECK(numbers[3].unit == "N");
  CHECK(numbers[3].text == "1e-20");
}

TEST_CASE("names_of_columns_read_back_to_keys_and_units") {
  CHECK(column_name("density/discs", "kg/m³") == "density.discs_kg_per_m3");
  CHECK(column_name("growth_rate", "1/s") == "growth_rate_per_s");
  CHECK(column_name("stiffness_ratio", "") == "stiffness_ratio");
  std::set<std::string> paths;
  for (const ResultQuantity& quantity : result_quantities()) {
    CAPTURE(quantity.path);
    CHECK(paths.insert(quantity.path).second);
    CHECK_FALSE(quantity.label.empty());
    const ScalarNumber number = number_of_column(column_name(quantity.path, quantity.unit));
    CHECK(number.path == quantity.path);
    CHECK(number.unit == quantity.unit);
  }
}
