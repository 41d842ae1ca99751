// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Derivatives of frequencies, speeds of sound and the critical ratio by springs against differences of fourth order,
/// along a random direction in the space of all springs.

#include <cmath>
#include <functional>
#include <string>

#include "equidem/assembly/lattices.hpp"
#include "equidem/statics/critical_ratio.hpp"
#include "equidem/waves/stability.hpp"

#include "support/catch.hpp"
#include "waves/networks.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

struct SpringsOfContacts {
  std::vector<double> kN, kT, kM;
};

ContactSprings springs_along(const SpringsOfContacts& at, const SpringsOfContacts& along, double t) {
  std::vector<SpringConstants> constants;
  std::vector<double> bending;
  for (std::size_t c = 0; c < at.kN.size(); ++c) {
    constants.push_back({at.kN[c] + t * along.kN[c], at.kT[c] + t * along.kT[c]});
    if (!at.kM.empty()) bending.push_back(at.kM[c] + t * along.kM[c]);
  }
  const ContactSprings springs(constants);
  return bending.empty() ? springs : springs.with_bending(bending);
}

SpringsOfContacts drawn(const Assembly& assembly, bool bend, double middle, double spread, Random& random) {
  SpringsOfContacts found;
  for (std::size_t c = 0; c < assembly.contacts.size(); ++c) {
    found.kN.push_back(middle + spread * random.uniform(-1, 1));
    found.kT.push_back(0.5 * middle + spread * random.uniform(-1, 1));
    if (bend) found.kM.push_back(0.3 * middle + spread * random.uniform(-1, 1));
  }
  return found;
}

/// The derivative along a direction, and the sum of the magnitudes of its terms.
struct AlongDirection {
  double sum = 0, magnitude = 0;
};
AlongDirection derivative_along(const SpringDerivatives& by, const SpringsOfContacts& along) {
  AlongDirection all;
  const auto add = [&](const std::vector<double>& each, const std::vector<double>& steps) {
    for (std::size_t c = 0; c < each.size(); ++c) {
      all.sum += each[c] * steps[c];
      all.magnitude += std::abs(each[c] * steps[c]);
    }
  };
  add(by.by_kN, along.kN), add(by.by_kT, along.kT), add(by.by_kM, along.kM);
  return all;
}

double difference(const std::function<double(double)>& value, double h) {
  const auto central = [&](double t) { return (value(t) - value(-t)) / (2 * t); };
  return (4 * central(h / 2) - central(h)) / 3;
}

double sum_of_shares(const SpringDerivatives& by, const ContactSprings& springs) {
  double sum = 0;
  for (std::size_t c = 0; c < by.by_kN.size(); ++c) sum += by.change_by(springs, c);
  return sum;
}

/// An error of the differences: h⁴ of the direction with derivatives of order 1, and rounding over h.
constexpr double step = 2e-3, of_differences = 1e-7;

}  // namespace

TEST_CASE("frequencies_change_with_springs_as_their_derivatives_say") {
  const bool bend = GENERATE(false, true), periodic = GENERATE(false, true), dense = GENERATE(true, false);
  const Assembly assembly = periodic ? random_cell(40, 3) : hexagonal_lattice({.columns = 7, .rows = 4, .radius = 1});
  Random random(5);
  const SpringsOfContacts at = drawn(assembly, bend, 1, 0.2, random), along = drawn(assembly, bend, 0, 1, random);
  const ContactSprings springs = springs_along(at, along, 0);
  const auto inertia = inertia_of(assembly.radii, 1, Body::disc);
  std::vector<Support> supports;
  if (!periodic) supports.push_back({.group = "left", .ux = 0.0, .uy = 0.0, .rotation = {}});
  const DegreesOfFreedom unknowns =
      number_unknowns(assembly, springs, derive_effects(springs, Rotation::from_scene), supports);
  NaturalFrequencyOptions options{
      .tolerance = 1e-11, .dense_limit = dense ? std::size_t{1000} : std::size_t{0}, .derivatives = true};
  const NaturalFrequencies found = natural_frequencies(assembly, springs, unknowns, inertia, options);
  REQUIRE(found.derivatives.size() == 4);
  REQUIRE(found.squared.size() == 4);
  options.derivatives = false;
  for (std::size_t k = 0; k < 4; ++k) {
    const FrequencyDerivatives& by = found.derivatives[k];
    const double omega = std::sqrt(found.squared[k]);
    CAPTURE(bend, periodic, dense, k, omega, by.error, found.squared);
    REQUIRE(by.simple);
    CHECK(sum_of_shares(by, springs) == Approx(omega / 2).epsilon(1e-9 + by.error));  // Euler: of degree 1/2
    const AlongDirection all = derivative_along(by, along);
    const double slope = difference(
        [&](double t) {
          const ContactSprings at_t = springs_along(at, along, t);
          return std::sqrt(natural_frequencies(assembly, at_t, unknowns, inertia, options).squared[k]);
        },
        step);
    CAPTURE(slope, all.sum, all.magnitude);
    CHECK(std::abs(slope - all.sum) <= of_differences * all.magnitude + by.error * omega);
  }
}

TEST_CASE("the_error_of_derivatives_is_as_large_as_is_said_where_iterations_end_early") {
  const Assembly assembly = random_cell(120, 4);
  Random random(9);
  const SpringsOfContacts at = drawn(assembly, false, 1, 0.2, random);
  const ContactSprings springs = springs_along(at, at, 0);
  const auto inertia = inertia_of(assembly.radii, 1, Body::disc);
  const DegreesOfFreedom unknowns =
      number_unknowns(assembly, springs, derive_effects(springs, Rotation::from_scene), {});
  const auto found = [&](double tolerance) {
    return natural_frequencies(assembly, springs, unknowns, inertia,
                               {.count = 6, .tolerance = tolerance, .dense_limit = 0, .derivatives = true});
  };
  const NaturalFrequencies exact = found(1e-12), coarse = found(1e-2);
  double largest = 0;
  for (std::size_t k = 0; k < 6; ++k) {
    if (!coarse.derivatives[k].simple) continue;
    double error = 0;
    for (std::size_t c = 0; c < assembly.contacts.size(); ++c)
      error += springs[c].kN * std::abs(coarse.derivatives[k].by_kN[c] - exact.derivatives[k].by_kN[c]) +
               springs[c].kT * std::abs(coarse.derivatives[k].by_kT[c] - exact.derivatives[k].by_kT[c]);
    const double said = (coarse.derivatives[k].error + exact.derivatives[k].error) * std::sqrt(exact.squared[k]);
    CAPTURE(k, error, said);
    CHECK(error <= said);
    largest = std::max(largest, error / said);
  }
  CAPTURE(largest);
  CHECK(largest > 0);
}

// Motions of a symmetric cell come in pairs; a cell of one kind of springs has others that are alone.
TEST_CASE("frequencies_that_coincide_have_no_derivatives") {
  const Assembly cell = periodic_hexagonal(4, 4);
  const ContactSprings springs(SpringConstants{1, 0.5});
  const Stability s = analyze_stability(cell, springs, {}, {.natural_frequencies = 5, .derivatives = true});
  std::size_t alone = 0;
  for (std::size_t k = 0; k < 5; ++k) {
    const double squared = s.natural.squared[k];
    const bool beside = (k > 0 && std::abs(squared - s.natural.squared[k - 1]) < 1e-6 * squared) ||
                        (k < 4 && std::abs(squared - s.natural.squared[k + 1]) < 1e-6 * squared);
    CAPTURE(k, s.natural.squared, beside);
    if (beside) CHECK_FALSE(s.natural.derivatives[k].simple);
    CHECK(s.natural.derivatives[k].by_kN.empty() != s.natural.derivatives[k].simple);
    alone += s.natural.derivatives[k].simple ? 1 : 0;
  }
  CHECK(alone < 5);
  CHECK(s.critical.by_kN.empty());  // a wave of the survey
  // a cell of 2 x 4 discs has all three points M, one of 2 x 2 has one
  const auto by_kN = [&](int rows) {
    return find_critical_ratio(periodic_hexagonal(2, rows), springs, {}, {.derivatives = true}).by_kN;
  };
  CHECK(by_kN(4).empty());
  CHECK_FALSE(by_kN(2).empty());
}

TEST_CASE("the_critical_ratio_changes_with_springs_as_its_derivatives_say") {
  struct Scene {
    std::string name;
    Assembly assembly;
    std::vector<Support> supports;
    CriticalRatioOptions options;
  };
  const std::vector<Scene> scenes{
      {"repeats with the cell", random_cell(30, 2), {}, {}},
      {"changes sign along x", random_cell(30, 2), {}, {.antiperiodic_x = true}},
      {"changes sign along both", random_cell(30, 2), {}, {.antiperiodic_x = true, .antiperiodic_y = true}},
      {"rotation restrained", random_cell(30, 2), {}, {.rotation = false}},
      {"held at the left",
       hexagonal_lattice({.columns = 6, .rows = 4, .radius = 1}),
       {{.group = "left", .ux = 0.0, .uy = 0.0, .rotation = {}}},
       {}},
      {"free", hexagonal_lattice({.columns = 6, .rows = 4, .radius = 1}), {}, {}}};
  for (const Scene& scene : scenes) {
    Random random(7);
    const SpringsOfContacts at = drawn(scene.assembly, false, 1, 0.2, random),
                            along = drawn(scene.assembly, false, 0, 1, random);
    CriticalRatioOptions options = scene.options;
    options.tolerance = 1e-12;
    options.derivatives = true;
    const ContactSprings springs = springs_along(at, along, 0);
    const CriticalRatio found = find_critical_ratio(scene.assembly, springs, scene.supports, options);
    CAPTURE(scene.name, found.ratio);
    REQUIRE(found.by_kN.size() == scene.assembly.contacts.size());
    const SpringDerivatives by{found.by_kN, {}, {}};
    const AlongDirection all = derivative_along(by, along);
    CHECK(std::abs(sum_of_shares(by, springs)) <= 1e-8 * derivative_along(by, at).magnitude);  // Euler: of degree 0
    options.derivatives = false;
    const double slope = difference(
        [&](double t) {
          return find_critical_ratio(scene.assembly, springs_along(at, along, t), scene.supports, options).ratio;
        },
        step);
    CAPTURE(slope, all.sum, all.magnitude);
    CHECK(std::abs(slope - all.sum) <= 10 * of_differences * all.magnitude);
  }
}

TEST_CASE("speeds_of_sound_change_with_springs_as_their_derivatives_say") {
  const bool bend = GENERATE(false, true);
  const Assembly cell = random_cell(40, 6);
  Random random(3);
  const SpringsOfContacts at = drawn(cell, bend, 1, 0.2, random), along = drawn(cell, bend, 0, 1, random);
  const auto found = [&](double t, bool derivatives) {
    return analyze_stability(cell, springs_along(at, along, t), {},
                             {.natural_frequencies = 0, .derivatives = derivatives});
  };
  const Stability s = found(0, true), up = found(step, false), down = found(-step, false);
  REQUIRE(s.sound_derivatives.size() == 4);
  for (const SoundDerivatives& sound : s.sound_derivatives) {
    const std::size_t place = sound.angle == 0 ? 0 : 6;  // of every 15 degrees
    const auto speed = [&](const Stability& of) {
      const PlaneWaves& waves = of.sound[place];
      return std::sqrt(sound.transverse ? waves.transverse_squared : waves.longitudinal_squared);
    };
    const AlongDirection all = derivative_along(sound, along);
    const double slope = (speed(up) - speed(down)) / (2 * step);
    CAPTURE(bend, sound.angle, sound.transverse, sound.speed, speed(s), slope, all.sum, all.magnitude);
    CHECK(sound.speed == Approx(speed(s)).epsilon(1e-12));
    CHECK(sum_of_shares(sound, springs_along(at, along, 0)) == Approx(sound.speed / 2).epsilon(1e-9));
    CHECK(std::abs(slope - all.sum) <= 10 * step * step * all.magnitude);  // of second order
  }
}
