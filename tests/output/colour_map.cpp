// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>

#include "equidem/core/random.hpp"
#include "equidem/output/pictures/canvas.hpp"

#include "support/catch.hpp"

using namespace equidem;

namespace {

double to_linear(double srgb) {
  return srgb <= 0.04045 ? srgb / 12.92 : std::pow((srgb + 0.055) / 1.055, 2.4);
}

/// Perceived lightness, the L of Oklab (Ottosson 2020), in [0, 1].
double lightness(const Colour& colour) {
  const double r = to_linear(colour.red), g = to_linear(colour.green), b = to_linear(colour.blue);
  return 0.2104542553 * std::cbrt(0.4122214708 * r + 0.5363325363 * g + 0.0514459929 * b) +
         0.7936177850 * std::cbrt(0.2119034982 * r + 0.6806995451 * g + 0.1073969566 * b) -
         0.0040720468 * std::cbrt(0.0883024619 * r + 0.2817188376 * g + 0.6299787005 * b);
}

}  // namespace

TEST_CASE("equal_steps_of_the_number_are_equal_steps_of_lightness") {
  // Lightness is linear in each piece of a map; the pieces differ.
  const auto check_piece = [](ColourMap map, double from, double to) {
    constexpr int steps = 16;
    const double first = lightness(colour_at(map, from));
    const double whole = lightness(colour_at(map, to)) - first;
    for (int k = 1; k < steps; ++k) {
      const double t = from + (to - from) * k / steps;
      const double expected = first + whole * k / steps;
      CAPTURE(t, lightness(colour_at(map, t)), expected);
      CHECK(std::abs(lightness(colour_at(map, t)) - expected) < 0.004);
    }
  };
  check_piece(ColourMap::diverging, 0, 0.5);
  check_piece(ColourMap::diverging, 0.5, 1);
  check_piece(ColourMap::sequential, 0, 1);
}

TEST_CASE("the_diverging_map_weighs_both_signs_alike") {
  for (double t = 0; t <= 0.5; t += 0.05) {
    CAPTURE(t);
    CHECK(std::abs(lightness(colour_at(ColourMap::diverging, t)) - lightness(colour_at(ColourMap::diverging, 1 - t))) <
          0.004);
  }
  CHECK(lightness(colour_at(ColourMap::diverging, 0.5)) > 0.95);
}

TEST_CASE("numbers_of_both_signs_get_a_symmetric_scale") {
  const ColourScale scale = colour_scale(std::vector<double>{-1, 0.2, 3, NAN});
  CHECK(scale.map == ColourMap::diverging);
  CHECK(scale.low == -3);
  CHECK(scale.high == 3);
  CHECK_FALSE(scale.clipped_above);
}

TEST_CASE("numbers_of_one_sign_are_dark_where_they_are_large") {
  const double sign = GENERATE(1.0, -1.0);
  std::vector<double> values;
  for (int k = 0; k <= 100; ++k) values.push_back(sign * (1 + 0.1 * k));
  const ColourScale scale = colour_scale(values);
  CHECK(scale.map == ColourMap::sequential);
  CHECK(lightness(scale.colour_of(values.back())) < lightness(scale.colour_of(values.front())) - 0.3);
}

TEST_CASE("rounding_is_not_shown_as_a_pattern") {
  Random random(1);
  std::vector<double> values;
  for (int k = 0; k < 200; ++k) values.push_back(1e6 * (1 + 1e-13 * random.uniform(-1, 1)));
  const ColourScale scale = colour_scale(values);
  for (const double value : values) {
    CHECK(std::abs(scale.colour_of(value).green - scale.colour_of(1e6).green) < 1e-6);
  }
  CHECK(scale.low < scale.high);
  for (const std::vector<double>& flat : {std::vector<double>{0, 0}, {}, {NAN}, {5}, {-5}}) {
    const ColourScale flat_scale = colour_scale(flat);
    CHECK(flat_scale.low != flat_scale.high);
  }
}

TEST_CASE("one_extreme_does_not_set_the_scale") {
  std::vector<double> values;
  for (int k = 0; k < 1000; ++k) values.push_back(k);
  values.push_back(1e6);
  const ColourScale scale = colour_scale(values);
  CHECK(scale.high < 1100);
  CHECK(scale.clipped_above);
  CHECK_FALSE(std::isnan(scale.colour_of(1e6).red));
}

TEST_CASE("ticks_are_round_and_inside") {
  Random random(3);
  for (int k = 0; k < 200; ++k) {
    const double low = random.uniform(-1, 1) * std::pow(10, random.uniform(-9, 9));
    const double high = low + std::max(std::pow(10, random.uniform(-9, 9)), 1e-6 * std::abs(low));
    const std::vector<double> ticks = nice_ticks(low, high);
    CAPTURE(low, high, ticks);
    REQUIRE(ticks.size() >= 2);
    CHECK(ticks.size() <= 11);
    CHECK(ticks.front() >= low - 1e-6 * (high - low));
    CHECK(ticks.back() <= high + 1e-6 * (high - low));
    const double step = ticks[1] - ticks[0];
    const double lead = step / std::pow(10.0, std::floor(std::log10(step * 1.0001)));
    CHECK((std::abs(lead - 1) < 1e-3 || std::abs(lead - 2) < 1e-3 || std::abs(lead - 5) < 1e-3));
  }
}

TEST_CASE("prefixes_keep_numbers_between_1_and_1000") {
  for (const double value : {2e-9, 3e-5, 0.4, 5.0, 600.0, 7e3, 8e6, 9e11, 1e14}) {
    const UnitPrefix prefix = unit_prefix(value);
    CAPTURE(value, prefix.prefix);
    CHECK(value * prefix.factor >= 1 - 1e-12);
    CHECK(value * prefix.factor < 1000);
  }
  CHECK(unit_prefix(8e6).prefix == "M");
  CHECK(unit_prefix(0).prefix.empty());
}
