// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "equidem/assembly/delaunay.hpp"
#include "equidem/assembly/lattices.hpp"
#include "equidem/breakage/calibrate/calibrate_strength.hpp"
#include "equidem/core/error.hpp"

#include "breakage/scenes.hpp"
#include "support/assemblies.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

const ContactSprings rock_springs(SpringConstants{1e9, 4e8});

/// Random samples whose strengths scatter, each with seeds of its own.
std::vector<SeededSample> rocks(int count, double radius = 1e-3) {
  std::vector<SeededSample> samples;
  for (int k = 0; k < count; ++k) {
    const auto seed = static_cast<std::uint64_t>(k + 1);
    samples.push_back(
        {StrengthSample(
             delaunay_assembly(
                 {.discs = 70, .seed = seed, .radii = {.smallest = radius, .largest = radius}, .aspect = 0.6}),
             rock_springs, {}),
         seed});
  }
  return samples;
}

StrengthOptions scattered(double friction = 0.5) {
  return {.friction = friction, .weibull_modulus = 6};
}

/// Mean strengths of the samples in tension and compression, Pa.
std::pair<double, double> strengths_of(const std::vector<SeededSample>& samples, StrengthOptions strengths,
                                       double tension, double shear) {
  double pulled = 0, pressed = 0;
  for (const SeededSample& one : samples) {
    strengths.tension = tension;
    strengths.shear = shear;
    strengths.seed = one.seed;
    const ContactStrengths drawn = contact_strengths(one.sample.assembly(), strengths);
    pulled += one.sample.strength(StrengthTestKind::tension, drawn).stress;
    pressed += one.sample.strength(StrengthTestKind::compression, drawn).stress;
  }
  const auto count = static_cast<double>(samples.size());
  return {pulled / count, pressed / count};
}

/// Discs in a row along x.
Assembly row_of_discs(int contacts) {
  Assembly row = chain_of_discs(contacts + 1, 0.5);
  row.groups["left"].discs = {0};
  row.groups["right"].discs = {contacts};
  return row;
}

}  // namespace

TEST_CASE("strengths_of_a_sample_scale_with_those_of_its_contacts") {
  const auto samples = rocks(1);
  const auto [tension, compression] = strengths_of(samples, scattered(), 1, 1.5);
  const auto [larger_tension, larger_compression] = strengths_of(samples, scattered(), 7e3, 1.05e4);
  CHECK(larger_tension == Approx(7e3 * tension).epsilon(1e-12));
  CHECK(larger_compression == Approx(7e3 * compression).epsilon(1e-12));
  CHECK(compression > 2 * tension);
}

TEST_CASE("a_chain_is_as_strong_as_its_weakest_link") {
  // The minimum of n strengths of Weibull's law has the mean Gamma(1 + 1/m) n^(-1/m).
  const double m = 3;
  for (const int n : {1, 5, 40}) {
    const StrengthSample sample(row_of_discs(n), rock_springs, {.axis = LoadAxis::x, .rotation = Rotation::restrained});
    std::vector<double> strengths;
    for (std::uint64_t seed = 1; seed <= 300; ++seed) {
      const ContactStrengths drawn =
          contact_strengths(sample.assembly(), {.tension = 2, .shear = 2, .weibull_modulus = m, .seed = seed});
      const SampleStrength found = sample.strength(StrengthTestKind::tension, drawn);
      REQUIRE(found.stress * sample.width() == Approx(*std::ranges::min_element(drawn.tension)).epsilon(1e-12));
      REQUIRE(found.events == 1);
      strengths.push_back(found.stress * sample.width());
    }
    const MeanEstimate mean = estimate_mean(strengths, 0.95);
    const double theory = 2 * std::tgamma(1 + 1 / m) * std::pow(n, -1 / m);
    CAPTURE(n, mean.mean, mean.standard_error, theory);
    CHECK(std::abs(mean.mean - theory) < 4 * mean.standard_error);
  }
  const StrengthSample pressed(row_of_discs(3), rock_springs, {.axis = LoadAxis::x, .rotation = Rotation::restrained});
  const ContactStrengths equal = equal_strengths(pressed.assembly(), 1, 1);
  CHECK(pressed.strength(StrengthTestKind::compression, equal).stress == std::numeric_limits<double>::infinity());
}

TEST_CASE("strengths_that_were_computed_lead_back_to_those_of_the_contacts") {
  const auto samples = rocks(3);
  const auto [tension, compression] = strengths_of(samples, scattered(), 2e3, 2.6e3);
  const StrengthTargets wanted{.tensile = tension, .compressive = compression, .toughness = {}, .notches = {}};
  const StrengthCalibration found =
      calibrate_strength(samples, wanted, {.strengths = scattered(), .shear_over_tension = {}});
  CAPTURE(found.tension, found.shear, found.ratio, compression / tension, found.tests, found.tried.size());
  CHECK(found.tensile.mean == Approx(tension).epsilon(1e-12));
  CHECK(found.second.mean == Approx(compression).epsilon(0.005));
  CHECK(found.tension == Approx(2e3).epsilon(0.03));
  CHECK(found.shear == Approx(2.6e3).epsilon(0.08));
  CHECK(found.friction == 0.5);
  CHECK(found.tension_error > 0);
  CHECK(found.energy_error < 1e-10);
  // With the strengths found, the samples bear what is said of each.
  StrengthOptions again = scattered();
  for (std::size_t k = 0; k < samples.size(); ++k) {
    again.tension = found.tension;
    again.shear = found.shear;
    again.seed = samples[k].seed;
    const ContactStrengths drawn = contact_strengths(samples[k].sample.assembly(), again);
    CHECK(samples[k].sample.strength(StrengthTestKind::tension, drawn).stress ==
          Approx(found.samples[k].tensile).epsilon(1e-12));
    CHECK(samples[k].sample.strength(StrengthTestKind::compression, drawn).stress ==
          Approx(found.samples[k].second).epsilon(1e-12));
  }
}

TEST_CASE("the_friction_is_found_where_shear_over_tension_is_given") {
  const auto samples = rocks(2);
  const auto [tension, compression] = strengths_of(samples, scattered(0.7), 2e3, 3e3);
  const StrengthTargets wanted{.tensile = tension, .compressive = compression, .toughness = {}, .notches = {}};
  const StrengthCalibration found =
      calibrate_strength(samples, wanted, {.strengths = scattered(0), .shear_over_tension = 1.5});
  CAPTURE(found.friction, found.ratio, compression / tension);
  CHECK(found.second.mean == Approx(compression).epsilon(0.005));
  CHECK(found.shear == Approx(1.5 * found.tension).epsilon(1e-12));
  CHECK(std::abs(found.friction - 0.7) < 0.15);
}

TEST_CASE("a_ratio_that_samples_cannot_have_is_refused_with_the_range_that_they_have") {
  const auto samples = rocks(1);
  for (const double ratio : {0.5, 500.0}) {
    CAPTURE(ratio);
    const StrengthTargets wanted{.tensile = 1e6, .compressive = ratio * 1e6, .toughness = {}, .notches = {}};
    try {
      static_cast<void>(calibrate_strength(samples, wanted, {.strengths = scattered(), .shear_over_tension = {}}));
      FAIL("was not refused");
    } catch (const InfeasibleStrengths& error) {
      CHECK_THAT(error.what(), Catch::Contains("is not feasible with this sample (it has"));
      CHECK_THAT(error.what(), Catch::Contains(ratio < 1 ? "Take a smaller friction, or fewer bonds" : "more bonds"));
      CHECK_THAT(error.what(), Catch::Contains("friction does not raise it") || Catch::Contains("a smaller friction"));
      const StrengthCalibration& nearest = error.found();
      CHECK(nearest.ratio == (ratio < 1 ? nearest.lowest_ratio() : nearest.highest_ratio()));
      CHECK(nearest.tensile.mean == Approx(1e6));
      CHECK(nearest.tried.size() > 2);
    }
  }
  const StrengthTargets none{.tensile = 1e6, .compressive = {}, .toughness = {}, .notches = {}};
  CHECK_THROWS_AS(calibrate_strength(samples, none, {.strengths = scattered(), .shear_over_tension = {}}), Error);
  const StrengthTargets wanted{.tensile = 1e6, .compressive = 1e7, .toughness = {}, .notches = {}};
  CHECK_THROWS_WITH(
      calibrate_strength(
          samples,
          {.tensile = 1e6, .compressive = {}, .toughness = 1e4, .notches = {0.8 * samples.front().sample.width()}},
          {.strengths = scattered(), .shear_over_tension = {}}),
      Catch::Contains("0.7 of the width"));
  CHECK_THROWS_AS(calibrate_strength({}, wanted, {.strengths = scattered(), .shear_over_tension = {}}), Error);
  CHECK_THROWS_AS(
      calibrate_strength(samples, wanted, {.strengths = {.tension = 1, .friction = 0.5}, .shear_over_tension = {}}),
      Error);
  CHECK_THROWS_AS(StrengthSample(hexagonal_lattice({.columns = 4, .rows = 4, .periodic = true}), rock_springs, {}),
                  Error);
}

TEST_CASE("toughness_and_strength_scale_with_the_size_of_discs") {
  // Forces of contacts f, radius r: stresses are f/r and toughnesses f/sqrt(r).
  const auto small = rocks(1), large = rocks(1, 4e-3);
  const auto ratio = [&](const std::vector<SeededSample>& samples) {
    const StrengthSample& one = samples.front().sample;
    const ContactStrengths drawn = contact_strengths(one.assembly(), {.tension = 1e3, .shear = 2e3, .friction = 0.5});
    const double notch = 0.3 * one.width();
    const double stress = one.strength(StrengthTestKind::tension, drawn, notch).stress;
    return notch_toughness(stress, notch, one.width()) / one.strength(StrengthTestKind::tension, drawn).stress;
  };
  CHECK(ratio(large) == Approx(2 * ratio(small)).epsilon(1e-9));
  const double a = 1e-3;
  CHECK(notch_toughness(1e6, 2 * a, 1) == Approx(1e6 * std::sqrt(std::numbers::pi * a)).epsilon(1e-4));
}

TEST_CASE("notched_lattices_have_one_toughness") {
  // Strength times the root of the length, with the correction for the width, does not depend on the length.
  const StrengthSample plate(hexagonal_lattice({.columns = 41, .rows = 95, .radius = 0.5}), rock_springs,
                             {.fallen_to = 0.9});
  const ContactStrengths strengths = equal_strengths(plate.assembly(), 1, 1e6);
  std::vector<double> toughness;
  for (const double notch : {8.0, 12.0, 16.0, 24.0}) {
    const SampleStrength found = plate.strength(StrengthTestKind::tension, strengths, notch);
    toughness.push_back(notch_toughness(found.stress, notch, plate.width()));
    CHECK(found.energy_error < 1e-10);
  }
  CAPTURE(toughness);
  const auto [least, most] = std::ranges::minmax(toughness);
  CHECK(most < 1.05 * least);
}
