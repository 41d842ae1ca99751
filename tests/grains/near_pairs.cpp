// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The packed loop over pairs of discs.
#include "grains/resuming.hpp"
#include "grains/scenes.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

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
