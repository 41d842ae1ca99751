// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The packed loops over pairs of parts do what the loop over single contacts does.
#include "grains/one_by_one.hpp"
#include "grains/shapes.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

TEST_CASE("contacts_of_parts_by_eights_are_contacts_one_by_one") {
  const Stepping stepping = GENERATE(from_range(force_steppings));
  const ContactEnd end = GENERATE(ContactEnd::at_zero_force, ContactEnd::at_zero_overlap);
  const double friction = GENERATE(0.0, 0.05, 0.4);
  const bool needles = GENERATE(false, true);
  GrainScene scene = mixed_box(stepping.law, 5, 4, 61);
  scene.pairs[0].friction = friction;
  scene.pairs[0].end = end;
  if (needles) {
    for (Grain& grain : scene.grains) {
      if (grain.shape() != GrainShape::clump) grain.short_half_axis = grain.radius / 20;
    }
  }
  const GrainOptions options = options_of(stepping, 0.004);
  GrainSimulation eights(scene, options), singles(scene, one_by_one(options));
  const bool predicts = stepping.integrator == GrainIntegrator::semi_implicit_euler;
  constexpr double order = 1e-11;
  double apart = 0;
  for (int k = 0; k < 240; ++k) {
    eights.advance(1);
    singles.advance(1);
    apart = std::max(apart, distance_of_motions(eights, singles));
    const EnergyLedger a = eights.energy(), b = singles.energy();
    CAPTURE(stepping.name(), static_cast<int>(end), friction, needles, k, apart);
    REQUIRE(apart < 1e-9);
    REQUIRE(eights.counters().contacts == singles.counters().contacts);
    REQUIRE(eights.counters().evaluations == singles.counters().evaluations);
    // by Euler each predicts the mean velocity of the step, to its second order, from other numbers
    REQUIRE(a.lost_dashpot == Approx(b.lost_dashpot).epsilon(predicts ? 2e-2 : 1e-7).margin(order));
    REQUIRE(a.lost_slip == Approx(b.lost_slip).epsilon(1e-7).margin(order));
    REQUIRE(a.lost_tangential_dashpot == Approx(b.lost_tangential_dashpot).epsilon(1e-7).margin(order));
    REQUIRE(a.lost_release == Approx(b.lost_release).epsilon(1e-7).margin(order));
    REQUIRE(a.elastic_normal == Approx(b.elastic_normal).epsilon(1e-7).margin(1e-11));
    REQUIRE(a.elastic_tangential == Approx(b.elastic_tangential).epsilon(1e-7).margin(1e-11));
    const std::vector<GrainContact> here = eights.contacts(), there = singles.contacts();
    REQUIRE(here.size() == there.size());
    for (std::size_t c = 0; c < here.size(); ++c) {
      if (here[c].overlap != Approx(there[c].overlap).margin(1e-9))
        continue;  // clumps: two contacts of a pair in any order
      REQUIRE(here[c].i == there[c].i);
      REQUIRE(here[c].j == there[c].j);
      REQUIRE(here[c].steps == there[c].steps);
      REQUIRE(norm(here[c].normal - there[c].normal) < 1e-7);
      REQUIRE(norm(here[c].arm_i - there[c].arm_i) < 1e-7);
      REQUIRE(norm(here[c].arm_j - there[c].arm_j) < 1e-7);
      REQUIRE(here[c].normal_force == Approx(there[c].normal_force).epsilon(1e-6).margin(1e-6));
      REQUIRE(here[c].tangential_force == Approx(there[c].tangential_force).epsilon(1e-6).margin(1e-6));
    }
  }
  CHECK(eights.counters().contacts > 10);
  CHECK(eights.bytes_per_body() != singles.bytes_per_body());  // otherwise it is one loop twice
}

TEST_CASE("contacts_of_needles_are_those_that_brute_force_finds") {
  const double margin = GENERATE(0.0, 1e-6, 2.0);
  GrainOptions options = options_of({NormalLaw::linear_dashpot, GrainIntegrator::velocity_verlet}, 3e-4);
  options.margin = margin;
  GrainSimulation simulation(flying_needles(24, 31), options);
  std::size_t found = 0;
  for (int k = 0; k < 400; ++k) {
    simulation.advance(20);
    std::vector<std::pair<int, int>> expected, listed;
    const std::vector<Grain> grains = simulation.grains();
    const auto shape = [](const Grain& grain) {
      return Ellipse{grain.radius, grain.short_half_axis, axis_at(grain.angle)};
    };
    for (std::size_t i = 0; i < grains.size(); ++i) {
      for (std::size_t j = i + 1; j < grains.size(); ++j) {
        const Vec2 branch = grains[j].position - grains[i].position;
        if (contact_of_ellipses(shape(grains[i]), shape(grains[j]), branch).gap < 0) expected.emplace_back(i, j);
      }
    }
    for (const GrainContact& contact : simulation.contacts()) {
      if (contact.j >= 0) listed.emplace_back(std::minmax(contact.i, contact.j));
    }
    std::sort(listed.begin(), listed.end());
    CAPTURE(margin, k, expected.size(), listed.size());
    REQUIRE(listed == expected);
    found += expected.size();
  }
  CAPTURE(margin, simulation.counters().contacts, simulation.counters().rebuilds);
  CHECK(found > 20);
  CHECK(simulation.counters().contacts > 50);
  CHECK(simulation.counters().rebuilds > 2);
}
