// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The packed loops over pairs of discs and of parts do what the loop over single contacts does.
#include "grains/one_by_one.hpp"
#include "grains/shapes.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

TEST_CASE("contacts_by_eights_are_contacts_one_by_one") {
  enum Bodies { discs, two_kinds, shapes, needles };
  const Stepping stepping = GENERATE(from_range(force_steppings));
  const ContactEnd end = GENERATE(ContactEnd::at_zero_force, ContactEnd::at_zero_overlap);
  const double friction = GENERATE(0.0, 0.05, 0.4);
  const Bodies bodies = GENERATE(discs, two_kinds, shapes, needles);
  const bool round = bodies == discs || bodies == two_kinds;
  GrainScene scene = round ? busy_box(stepping.law, 5, 4, 31) : mixed_box(stepping.law, 5, 4, 61);
  scene.pairs[0].friction = friction;
  scene.pairs[0].end = end;
  if (bodies == two_kinds) {
    PairProperties other = scene.pairs[0], same = scene.pairs[0];
    other.stiffness *= 2;
    other.restitution = 0.5;
    same.friction = 0.2;
    scene.kinds = 2;
    scene.pairs = {scene.pairs[0], other, other, same};
    for (std::size_t k = 0; k < scene.grains.size(); k += 3) scene.grains[k].kind = 1;
  }
  for (Grain& grain : scene.grains)
    if (bodies == needles && grain.shape() != GrainShape::clump) grain.short_half_axis = grain.radius / 20;
  const GrainOptions options = options_of(stepping, round ? 0.005 : 0.004);
  GrainSimulation eights(scene, options), singles(scene, one_by_one(options));
  // by Euler each predicts the mean velocity of the step, to its second order, from other numbers
  const bool predicts = stepping.integrator == GrainIntegrator::semi_implicit_euler;
  const double of_dashpots = round ? 1e-3 : predicts ? 2e-2 : 1e-7, of_others = round ? 1e-8 : 1e-7;
  const double near = round ? 1e-9 : 1e-7;
  double apart = 0;
  for (int k = 0; k < (round ? 100 : 240); ++k) {
    eights.advance(1);
    singles.advance(1);
    apart = std::max(apart, distance_of_motions(eights, singles));
    const EnergyLedger a = eights.energy(), b = singles.energy();
    CAPTURE(stepping.name(), static_cast<int>(end), friction, static_cast<int>(bodies), k, apart);
    REQUIRE(apart < 1e-9);
    REQUIRE(eights.counters().contacts == singles.counters().contacts);
    REQUIRE(eights.counters().evaluations == singles.counters().evaluations);
    REQUIRE(a.lost_dashpot == Approx(b.lost_dashpot).epsilon(of_dashpots).margin(1e-11));
    for (double EnergyLedger::*term :
         {&EnergyLedger::lost_slip, &EnergyLedger::lost_tangential_dashpot, &EnergyLedger::lost_release,
          &EnergyLedger::elastic_normal, &EnergyLedger::elastic_tangential})
      REQUIRE(a.*term == Approx(b.*term).epsilon(of_others).margin(round ? 1e-12 : 1e-11));
    const std::vector<GrainContact> here = eights.contacts(), there = singles.contacts();
    REQUIRE(here.size() == there.size());
    for (std::size_t c = 0; c < here.size(); ++c) {
      const bool same = here[c].overlap == Approx(there[c].overlap).margin(1e-9);
      if (!round && !same) continue;  // clumps: two contacts of a pair in any order
      REQUIRE(same);
      REQUIRE(here[c].i == there[c].i);
      REQUIRE(here[c].j == there[c].j);
      REQUIRE(here[c].steps == there[c].steps);
      REQUIRE(norm(here[c].normal - there[c].normal) < near);
      REQUIRE(norm(here[c].arm_i - there[c].arm_i) < near);
      REQUIRE(norm(here[c].arm_j - there[c].arm_j) < near);
      if (round) REQUIRE(here[c].closing == Approx(there[c].closing).margin(1e-8));
      REQUIRE(here[c].normal_force == Approx(there[c].normal_force).epsilon(1e-6).margin(1e-6));
      REQUIRE(here[c].tangential_force == Approx(there[c].tangential_force).epsilon(1e-6).margin(1e-6));
    }
  }
  CHECK(eights.counters().contacts > 10);
  CHECK(eights.bytes_per_body() != singles.bytes_per_body());  // otherwise it is one loop twice
}

// Any number beside zero grows there: a column is as unstable as a rod on its tip.
TEST_CASE("discs_above_one_another_stay_so_to_the_last_bit") {
  const Stepping stepping = GENERATE(from_range(force_steppings));
  const double friction = GENERATE(0.0, 0.4);
  std::vector<Grain> column;
  for (int k = 0; k < 20; ++k) column.push_back(ball({0, 1.0 + 1.99 * k}, 1));
  PairProperties pair;
  pair.stiffness = 1e4;
  pair.restitution = 0.5;
  pair.friction = friction;
  pair.tangential_ratio = 0.5;
  GrainSimulation simulation(scene_of(column, {line("floor", {0, 0}, {0, 1})}, pair, {0, -1}),
                             options_of(stepping, 0.001));
  simulation.advance(500);
  CAPTURE(stepping.name(), friction);
  CHECK(simulation.counters().contacts > 19);
  for (const Grain& grain : simulation.grains()) {
    CHECK(grain.position.x == 0);
    CHECK(grain.velocity.x == 0);
    CHECK(grain.spin == 0);
  }
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
