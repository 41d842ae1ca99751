// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/output/results.hpp"

#include <cmath>
#include <limits>

#include "equidem/contact/effects.hpp"

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
