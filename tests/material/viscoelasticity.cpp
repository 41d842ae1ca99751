// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Complex springs over frequency: limits of the models, tables, frequencies.
#include "equidem/material/viscoelasticity.hpp"

#include <cmath>
#include <complex>
#include <numbers>

#include "support/catch.hpp"

using namespace equidem;

namespace {

using Factor = std::complex<double>;

}  // namespace

TEST_CASE("a_standard_solid_with_a_stiff_arm_is_a_kelvin_voigt_spring") {
  const ViscoelasticSpring voigt{.model = SpringModel::kelvin_voigt, .time = 0.3};
  for (const double arm : {1e3, 1e6}) {
    const ViscoelasticSpring solid{.model = SpringModel::standard_solid, .time = 0.3 / arm, .arm = arm};
    for (const double frequency : {1e-3, 0.5, 2.0}) {
      const Factor difference = solid.factor(frequency) - voigt.factor(frequency);
      CAPTURE(arm, frequency, difference);
      CHECK(std::abs(difference) < 20 / arm);
    }
  }
}

TEST_CASE("a_maxwell_spring_flows_slowly_and_is_elastic_at_speed") {
  const ViscoelasticSpring maxwell{.model = SpringModel::maxwell, .time = 1 / (2 * std::numbers::pi)};
  CHECK(std::abs(maxwell.factor(1) - Factor(0.5, 0.5)) < 1e-15);
  CHECK(std::abs(maxwell.factor(2) - Factor(0.8, 0.4)) < 1e-15);  // 2i/(1 + 2i)
  CHECK(maxwell.factor(1e-160).imag() > 0);
  CHECK(std::abs(maxwell.factor(1e200) - 1.0) < 1e-15);
  CHECK(std::abs(maxwell.factor(1e-6) / Factor(0, 1e-6) - 1.0) < 2e-6);
}

TEST_CASE("a_table_is_straight_over_the_logarithm_of_frequency") {
  const ViscoelasticSpring table{.model = SpringModel::table, .table = {{1, {1, 0.1}}, {100, {3, 0.5}}, {200, 4}}};
  CHECK(table.factor(1) == Factor(1, 0.1));
  CHECK(table.factor(200) == Factor(4));
  CHECK(std::abs(table.factor(10) - Factor(2, 0.3)) < 1e-15);
  CHECK_THROWS_WITH(table.factor(0.99), Catch::Contains("outside the table"));
  CHECK_THROWS_WITH(table.factor(200.1), Catch::Contains("outside the table"));
}

TEST_CASE("frequencies_reach_from_end_to_end_and_past_the_times_of_the_springs") {
  const std::vector<double> decades = logarithmic_frequencies(0.1, 1e3, 5);
  REQUIRE(decades.size() == 21);
  CHECK(decades.front() == 0.1);
  CHECK(decades.back() == 1e3);
  CHECK(std::abs(decades[5] - 1) < 1e-14);
  CHECK(logarithmic_frequencies(2, 2, 3) == std::vector<double>{2});
  CHECK_THROWS_WITH(logarithmic_frequencies(2, 1, 3), Catch::Contains("first is the lowest"));
  CHECK_THROWS_WITH(logarithmic_frequencies(1e-300, 1e300, 100), Catch::Contains("per decade"));
  const ViscoelasticSpring slow{.model = SpringModel::maxwell, .time = 10},
      fast{.model = SpringModel::kelvin_voigt, .time = 0.1};
  const std::vector<double> chosen = frequencies_of_interest({slow, fast}, 2);
  CHECK(std::abs(chosen.front() * 2 * std::numbers::pi * 10 - 1e-3) < 1e-15);
  CHECK(std::abs(chosen.back() * 2 * std::numbers::pi * 0.1 - 1e3) < 1e-9);
  CHECK_THROWS_WITH(frequencies_of_interest({}, 2), Catch::Contains("no spring has a dashpot"));
}
