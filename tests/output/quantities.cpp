// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/output/quantities.hpp"

#include <limits>
#include <set>
#include <vector>

#include "support/catch.hpp"

using namespace equidem;

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
