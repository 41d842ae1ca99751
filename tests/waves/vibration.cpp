// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Highest frequency and time steps of assemblies.
#include "equidem/waves/vibration.hpp"

#include <cmath>
#include <numbers>

#include "equidem/homogenize/tension_test.hpp"

#include "support/catch.hpp"
#include "support/fields.hpp"
#include "waves/networks.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

DegreesOfFreedom unknowns_of(const Assembly& assembly, const ContactSprings& springs,
                             std::span<const Support> supports = {}) {
  return number_unknowns(assembly, springs, derive_effects(springs, Rotation::from_scene), supports);
}

ExtremeEigenvalue highest(const Assembly& assembly, const ContactSprings& springs, const std::vector<Inertia>& inertia,
                          std::span<const Support> supports = {}) {
  return extreme_squared_frequency(assembly, springs, unknowns_of(assembly, springs, supports), inertia,
                                   SpectrumEnd::largest);
}

}  // namespace

TEST_CASE("the_highest_frequency_of_periodic_lattices_is_that_of_f10") {
  const double kT = GENERATE(0.0, 0.2, 1.0 / 3, 0.5, 1.0), beta = GENERATE(0.5, 0.4);
  const auto [columns, rows] = GENERATE(std::pair{2, 2}, std::pair{12, 10});
  const ContactSprings springs(SpringConstants{1, kT});
  const double turning = kT / beta;
  const Assembly hexagonal = periodic_hexagonal(columns, rows), square = periodic_square(columns, rows);
  const ExtremeEigenvalue h = highest(hexagonal, springs, unit_masses(hexagonal, beta));
  const ExtremeEigenvalue s = highest(square, springs, unit_masses(square, beta));
  CAPTURE(kT, beta, columns, rows, h.residual, h.products, s.residual, s.products);
  CHECK(h.converged);
  CHECK(h.residual < 1e-11);
  CHECK(h.value == Approx(std::max(6 + 2 * kT, 12 * turning)).epsilon(1e-12));
  CHECK(s.value == Approx(std::max(4 * (1 + kT), 8 * turning)).epsilon(1e-12));
}

TEST_CASE("the_table_of_time_steps_for_discs") {
  struct Row {
    double kT, hexagonal, square;
  };
  for (const Row& row : {Row{0, .8165, 1.000}, Row{.2, .7906, .9129}, Row{1.0 / 3, .7071, .8660}, Row{.5, .5774, .7071},
                         Row{1, .4082, .5000}}) {
    const ContactSprings springs(SpringConstants{1, row.kT});
    const Assembly hexagonal = periodic_hexagonal(4, 4), square = periodic_square(4, 4);
    CAPTURE(row.kT);
    CHECK(2 / std::sqrt(highest(hexagonal, springs, unit_masses(hexagonal)).value) ==
          Approx(row.hexagonal).margin(5e-5));
    CHECK(2 / std::sqrt(highest(square, springs, unit_masses(square)).value) == Approx(row.square).margin(5e-5));
  }
}

TEST_CASE("the_rules_for_the_hexagonal_lattice_of_equal_springs") {
  const Assembly assembly = periodic_hexagonal(4, 4);
  const ContactSprings springs(SpringConstants{1, 1});
  const auto disc = unit_masses(assembly, 0.5), sphere = unit_masses(assembly, 0.4);
  CHECK(2 / std::sqrt(element_bound(assembly, springs, disc, true)) == Approx(1.0 / 3).epsilon(1e-14));
  CHECK(2 / std::sqrt(element_bound(assembly, springs, sphere, true)) == Approx(0.3086).margin(5e-5));
  const TimeStepRules rules = time_step_rules(assembly, springs, disc, true);
  CHECK(rules.diagonal == Approx(0.4082).margin(5e-5));
  CHECK(rules.eighth_of_period == Approx(std::numbers::pi / 4).epsilon(1e-14));
}

// The guarantee: no assembly of any kind, springs of any spread, bodies of any weight, is faster than the bound.
TEST_CASE("no_assembly_vibrates_faster_than_its_element_bound") {
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    Random random(seed);
    DelaunayOptions options;
    options.discs = 4 + static_cast<std::int64_t>(random.below(60));
    options.seed = seed;
    options.periodic = random.below(2) == 0;
    options.radii = {1, std::pow(10, random.uniform())};
    options.points = random.below(2) == 0 ? PointProcess::uniform : PointProcess::poisson_disc;
    const Assembly assembly = delaunay_assembly(options);
    std::vector<SpringConstants> each(assembly.contacts.size());
    for (SpringConstants& k : each) k = {std::pow(10, random.uniform(-2, 2)), std::pow(10, random.uniform(-3, 2))};
    if (random.below(3) == 0) each.assign(each.size(), {1, -0.1});
    const ContactSprings springs(each);
    const auto inertia = inertia_of(assembly.radii, 2000, random.below(2) == 0 ? Body::disc : Body::sphere);
    const ExtremeEigenvalue found = highest(assembly, springs, inertia);
    const double bound = element_bound(assembly, springs, inertia, true);
    CAPTURE(seed, assembly.size(), assembly.periodic(), found.value, found.residual, found.products, bound);
    CHECK(found.converged);
    CHECK(found.residual <= 2e-12 * found.value);
    CHECK(found.value <= bound * (1 + 1e-12));
    CHECK(found.value > 0.05 * bound);  // and it is not idle
  }
}

TEST_CASE("the_bits_of_the_highest_frequency_do_not_depend_on_threads") {
  const Assembly assembly = random_cell(400, 8);
  const ContactSprings springs(SpringConstants{1, 0.4});
  const auto inertia = unit_masses(assembly);
  double first = 0;
  for (const int threads : {1, 2, 5}) {
    const ThreadsFor here(threads);
    const ExtremeEigenvalue found = highest(assembly, springs, inertia);
    if (threads == 1) first = found.value;
    CHECK(found.value == first);
  }
}

TEST_CASE("with_negative_kT_the_finite_assembly_grows_no_faster_than_the_lattice") {
  const double kT = -0.1;
  const ContactSprings springs(SpringConstants{1, kT});
  const Assembly block = hexagonal_lattice({.columns = 15, .rows = 15, .radius = 1});
  const ExtremeEigenvalue found =
      extreme_squared_frequency(block, springs, unknowns_of(block, springs), unit_masses(block), SpectrumEnd::smallest);
  CAPTURE(found.value, found.residual);
  CHECK(found.value < -0.9 * 24 * std::abs(kT));
  CHECK(found.value > -24 * std::abs(kT));
}

TEST_CASE("frequencies_scale_with_units_however_extreme") {
  const double scale = GENERATE(1e-200, 1e-60, 1e60, 1e200);
  const Assembly small = periodic_hexagonal(2, 2), large = random_cell(40, 5);  // dense, Lanczos
  for (const Assembly* assembly : {&small, &large}) {
    const auto squared = [&](double by) {
      std::vector<Inertia> inertia = unit_masses(*assembly);
      for (Inertia& body : inertia) body.mass *= by, body.moment *= by;
      return highest(*assembly, ContactSprings(SpringConstants{1, 0.4}), inertia);
    };
    const ExtremeEigenvalue one = squared(1), scaled = squared(scale);
    CAPTURE(scale, assembly->size(), one.value, scaled.value, scaled.residual);
    CHECK(scaled.converged);
    CHECK(scaled.value * scale == Approx(one.value).epsilon(1e-12));
    CHECK(scaled.residual * scale < 1e-10);
  }
}

TEST_CASE("magnitudes_whose_squares_are_no_numbers_are_refused") {
  const Assembly assembly = periodic_hexagonal(2, 2);
  const auto refused = [&](double mass, double kN) {
    std::vector<Inertia> inertia = unit_masses(assembly);
    for (Inertia& body : inertia) body.mass *= mass, body.moment *= mass;
    return !refusal_of([&] {
              check_magnitudes(assembly, ContactSprings(SpringConstants{kN, kN}), inertia);
            }).message.empty();
  };
  CHECK(refused(1e-300, 1));
  CHECK(refused(1e300, 1));
  CHECK(refused(1e-100, 1e100));
  CHECK(refused(1e100, 1e-100));
  CHECK(!refused(1e-100, 1));
  CHECK(!refused(1e100, 1e100));
}

TEST_CASE("tangential_springs_that_drown_the_normal_ones_are_refused") {
  const Assembly assembly = periodic_hexagonal(2, 2);
  for (const double sign : {1.0, -1.0}) {
    CHECK_NOTHROW(check_magnitudes(assembly, ContactSprings(SpringConstants{1, sign * 1e9}), unit_masses(assembly)));
    for (const double kT : {1e11, 1e150, 1e308}) {
      CHECK_THROWS_WITH(
          check_magnitudes(assembly, ContactSprings(SpringConstants{1, sign * kT}), unit_masses(assembly)),
          Catch::Contains("contact 0 has kT/kN = ") && Catch::Contains("so ill-scaled"));
    }
  }
}

// Discs that touch only their own images: K is zero, or negative where rotations have kT < 0.
TEST_CASE("a_cell_in_which_nothing_vibrates_has_the_frequency_zero") {
  const double kT = GENERATE(0.0, -0.1);
  const Assembly cell = periodic_square(1, 1);
  const ExtremeEigenvalue found = highest(cell, ContactSprings(SpringConstants{1, kT}), unit_masses(cell));
  CAPTURE(kT, found.value, found.residual);
  CHECK(found.converged);
  CHECK(std::abs(found.value) < 1e-14);
}
