// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Waves and vibrations of bonds that resist relative rotation.
#include <algorithm>
#include <cmath>
#include <vector>

#include "equidem/assembly/lattices.hpp"
#include "equidem/contact/contact_springs.hpp"
#include "equidem/core/error.hpp"
#include "equidem/statics/critical_ratio.hpp"
#include "equidem/waves/bloch.hpp"
#include "equidem/waves/natural_frequencies.hpp"
#include "equidem/waves/stability.hpp"
#include "equidem/waves/vibration.hpp"

#include "support/assemblies.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

constexpr double bent_radius = 0.5;
constexpr SpringConstants bent_springs{2, 0.6};
constexpr double bent_kM = 0.05;

/// The values that a wave vector has, off by at most 1e-12 of the largest.
void check_spectrum(std::vector<double> found, std::vector<double> wanted) {
  std::sort(wanted.begin(), wanted.end());
  REQUIRE(found.size() == wanted.size());
  for (std::size_t k = 0; k < wanted.size(); ++k) {
    CAPTURE(k, found[k], wanted[k]);
    CHECK(std::abs(found[k] - wanted[k]) < 1e-12 * wanted.back());
  }
}

}  // namespace

TEST_CASE("rotational_waves_of_the_hexagonal_lattice_have_the_closed_form_of_bent_bonds") {
  const Assembly cell = hexagonal_lattice({.columns = 4, .rows = 4, .radius = bent_radius, .periodic = true});
  const std::vector<Inertia> inertia = inertia_of(cell, 1.3, Body::disc);
  const ContactSprings springs = bending_springs(cell, ContactSprings(bent_springs), {.kM = bent_kM});
  const PrimitiveCell primitive = primitive_cell(cell, springs);
  REQUIRE(primitive.size() == 1);
  const BlochWaves waves(primitive, inertia, true);
  const double a = bent_radius, m = inertia[0].mass, I = inertia[0].moment;
  const auto [kN, kT] = bent_springs;
  // Bonds along 0, 60 and 120 degrees with phases p: kT a² sum 2 (1 + cos p) + kM sum 2 (1 - cos p) on rotations.
  check_spectrum(waves.squared_frequencies({0, 0}), {0, 0, 12 * kT * a * a / I});
  const Vec2 M{0, std::acos(-1.0) / (std::sqrt(3.0) * a)};  // phases 0, pi, pi: rotations do not couple
  check_spectrum(waves.squared_frequencies(M),
                 {(2 * kN + 6 * kT) / m, (6 * kN + 2 * kT) / m, (4 * kT * a * a + 8 * bent_kM) / I});
}

TEST_CASE("a_bond_vibrates_in_bending_as_its_closed_form") {
  Assembly pair = square_lattice({.columns = 2, .rows = 1, .radius = bent_radius});
  pair.groups["root"].discs = {0};
  const std::vector<Inertia> inertia = inertia_of(pair, 2, Body::disc);
  const ContactSprings springs = bending_springs(pair, ContactSprings(bent_springs), {.kM = bent_kM});
  const DegreesOfFreedom unknowns =
      number_unknowns(pair, springs, derive_effects(pair, springs, Rotation::from_scene),
                      std::vector<Support>{{.group = "root", .ux = 0.0, .uy = 0.0, .rotation = 0.0}});
  const NaturalFrequencies found = natural_frequencies(pair, springs, unknowns, inertia, {.count = 3});
  const double a = bent_radius, m = inertia[1].mass, I = inertia[1].moment;
  const auto [kN, kT] = bent_springs;
  // Along y and theta: kT (y - a theta)²/2 + kM theta²/2.
  const double yy = kT / m, tt = (kT * a * a + bent_kM) / I, yt = kT * a / std::sqrt(m * I);
  const double middle = 0.5 * (yy + tt), root = std::sqrt(0.25 * (yy - tt) * (yy - tt) + yt * yt);
  check_spectrum(found.squared, {middle - root, middle + root, kN / m});
}

TEST_CASE("the_bound_of_the_highest_frequency_holds_with_bending_springs") {
  for (const double kM : {0.01, 0.5, 20.0}) {
    const Assembly block = hexagonal_lattice({.columns = 7, .rows = 6, .radius = bent_radius});
    const std::vector<Inertia> inertia = inertia_of(block, 1, Body::disc);
    const ContactSprings springs = bending_springs(block, ContactSprings(bent_springs), {.kM = kM});
    const DegreesOfFreedom unknowns =
        number_unknowns(block, springs, derive_effects(block, springs, Rotation::from_scene), {});
    const ExtremeEigenvalue highest =
        extreme_squared_frequency(block, springs, unknowns, inertia, SpectrumEnd::largest);
    const double bound = element_bound(block, springs, inertia, true);
    CAPTURE(kM, highest.value, bound);
    CHECK(highest.value < bound);
    CHECK(bound < 3 * highest.value);
  }
}

TEST_CASE("the_critical_ratio_is_not_sought_of_bent_bonds") {
  const Assembly cell = hexagonal_lattice({.columns = 4, .rows = 4, .radius = bent_radius, .periodic = true});
  const ContactSprings springs = bending_springs(cell, ContactSprings(bent_springs), {.kM = bent_kM});
  CHECK_THROWS_AS(find_critical_ratio(cell, springs, {}, {}), Error);
  const Stability found = analyze_stability(cell, springs, {}, {.density = 1});
  CAPTURE(found.critical.searched);
  CHECK_FALSE(found.critical.sought);
  CHECK(found.status() == "stable");
}
