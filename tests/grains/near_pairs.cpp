// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The packed loop over pairs of discs does what the loop over single contacts does.
#include "grains/one_by_one.hpp"
#include "grains/resuming.hpp"
#include "grains/scenes.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

TEST_CASE("contacts_by_eights_are_contacts_one_by_one") {
  const Stepping stepping =
      GENERATE(from_range(std::vector<Stepping>(all_steppings.begin(), all_steppings.begin() + 4)));
  const ContactEnd end = GENERATE(ContactEnd::at_zero_force, ContactEnd::at_zero_overlap);
  const double friction = GENERATE(0.0, 0.05, 0.4);
  const bool two_kinds = GENERATE(false, true);
  GrainScene scene = busy_box(stepping.law, 5, 4, 31);
  scene.pairs[0].friction = friction;
  scene.pairs[0].end = end;
  if (two_kinds) {
    PairProperties other = scene.pairs[0], same = scene.pairs[0];
    other.stiffness *= 2;
    other.restitution = 0.5;
    same.friction = 0.2;
    scene.kinds = 2;
    scene.pairs = {scene.pairs[0], other, other, same};
    for (std::size_t k = 0; k < scene.grains.size(); k += 3) scene.grains[k].kind = 1;
  }
  const GrainOptions options = options_of(stepping, 0.005);
  GrainSimulation eights(scene, options), singles(scene, one_by_one(options));
  double apart = 0;
  for (int k = 0; k < 100; ++k) {
    eights.advance(1);
    singles.advance(1);
    apart = std::max(apart, distance_of_motions(eights, singles));
    const EnergyLedger a = eights.energy(), b = singles.energy();
    CAPTURE(stepping.name(), static_cast<int>(end), friction, two_kinds, k, apart);
    REQUIRE(apart < 1e-9);
    REQUIRE(eights.counters().contacts == singles.counters().contacts);
    REQUIRE(eights.counters().evaluations == singles.counters().evaluations);
    // each predicts the mean velocity of the step, to its second order, from other numbers
    REQUIRE(a.lost_dashpot == Approx(b.lost_dashpot).epsilon(1e-3).margin(1e-12));
    REQUIRE(a.lost_slip == Approx(b.lost_slip).epsilon(1e-8).margin(1e-12));
    REQUIRE(a.lost_tangential_dashpot == Approx(b.lost_tangential_dashpot).epsilon(1e-8).margin(1e-12));
    REQUIRE(a.lost_release == Approx(b.lost_release).epsilon(1e-8).margin(1e-12));
    REQUIRE(a.elastic_normal == Approx(b.elastic_normal).epsilon(1e-8).margin(1e-12));
    REQUIRE(a.elastic_tangential == Approx(b.elastic_tangential).epsilon(1e-8).margin(1e-12));
    const std::vector<GrainContact> here = eights.contacts(), there = singles.contacts();
    REQUIRE(here.size() == there.size());
    for (std::size_t c = 0; c < here.size(); ++c) {
      REQUIRE(here[c].i == there[c].i);
      REQUIRE(here[c].j == there[c].j);
      REQUIRE(here[c].steps == there[c].steps);
      REQUIRE(norm(here[c].normal - there[c].normal) < 1e-9);
      REQUIRE(here[c].overlap == Approx(there[c].overlap).margin(1e-9));
      REQUIRE(here[c].closing == Approx(there[c].closing).margin(1e-8));
      REQUIRE(here[c].normal_force == Approx(there[c].normal_force).epsilon(1e-6).margin(1e-6));
      REQUIRE(here[c].tangential_force == Approx(there[c].tangential_force).epsilon(1e-6).margin(1e-6));
    }
  }
  CAPTURE(stepping.name(), static_cast<int>(end), friction, two_kinds);
  CHECK(eights.counters().contacts > 10);
  CHECK(eights.bytes_per_body() != singles.bytes_per_body());  // otherwise it is one loop twice
}

TEST_CASE("steps_made_together_are_steps_made_one_at_a_time") {
  const Stepping stepping = GENERATE(from_range(all_steppings));
  const GrainScene scene = busy_box(stepping.law, 4, 4, 32);
  GrainSimulation together(scene, options_of(stepping, 0.005)), single(scene, options_of(stepping, 0.005));
  for (const int steps : {1, 7, 100, 300}) {
    together.advance(steps);
    for (int k = 0; k < steps; ++k) single.advance(1);
    CAPTURE(stepping.name(), steps);
    CHECK(bits_of(together) == bits_of(single));
  }
  CHECK(together.counters().contacts > 20);
}

// Any number beside zero grows there: a column is as unstable as a rod on its tip.
TEST_CASE("discs_above_one_another_stay_so_to_the_last_bit") {
  const Stepping stepping =
      GENERATE(from_range(std::vector<Stepping>(all_steppings.begin(), all_steppings.begin() + 4)));
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
