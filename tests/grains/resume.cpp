// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A run that was saved goes on as if it had never stopped.
#include <cmath>

#include "grains/bonded_scenes.hpp"
#include "grains/resuming.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

TEST_CASE("a_run_saved_at_any_step_goes_on_with_the_same_bits") {
  const Stepping stepping = GENERATE(from_range(all_steppings));
  CAPTURE(stepping.name());
  check_resuming(busy_box(stepping.law, 3, 3, 21), options_of(stepping, 0.01), 120);
}

TEST_CASE("bonds_saved_at_any_step_go_on_with_the_same_forces_whatever_they_are_of") {
  const Stepping stepping = GENERATE(from_range(bonding_steppings));
  const bool springs = GENERATE(true, false), dashpots = GENERATE(true, false), in_cell = GENERATE(true, false);
  if (!springs && !dashpots) return;
  GrainBond like;
  if (springs) like = {.normal_spring = 300, .tangential_spring = 100, .bending_spring = 5};
  if (dashpots) like.normal_dashpot = 3, like.tangential_dashpot = 2, like.rolling_dashpot = 0.1;
  GrainScene scene = busy_box(stepping.law, 4, 3, 5);
  for (const auto& [i, j] : {std::pair<std::size_t, std::size_t>{0, 1}, {1, 4}, {5, 8}, {6, 7}, {9, 10}, {10, 11}}) {
    scene.bonds.push_back(like);
    scene.bonds.back().i = i, scene.bonds.back().j = j;
  }
  if (springs && gives_force(stepping.law))
    scene.strengths = ContactStrengths{{14, 9, 99, 9, 14, 14}, {9, 5, 99, 5, 9, 9}, 0.2};
  if (in_cell) {
    if (!gives_force(stepping.law)) return;
    scene.walls.clear();
    for (Grain& grain : scene.grains) grain.velocity = 8 * grain.velocity;
    scene.gravity = {};
    scene.cell = PeriodicCell{.corner = {0, 0}, .width = 4, .height = 3};
  }
  const GrainOptions options = options_of(stepping, 4e-3);
  CAPTURE(stepping.name(), springs, dashpots, in_cell);
  check_resuming(scene, options, 100);
}

TEST_CASE("a_simulation_that_has_run_can_be_taken_back") {
  const Stepping stepping = GENERATE(from_range(all_steppings));
  GrainSimulation simulation(busy_box(stepping.law, 3, 3, 22), options_of(stepping, 0.01));
  simulation.advance(40);
  const SavedState state = simulation.save();
  const Bits then = bits_of(simulation);
  simulation.advance(60);
  const Bits first = bits_of(simulation);

  simulation.restore(state);

  CAPTURE(stepping.name());
  CHECK(bits_of(simulation) == then);
  simulation.advance(60);
  CHECK(bits_of(simulation) == first);
}

TEST_CASE("a_state_of_another_scene_is_refused") {
  GrainSimulation one(busy_box(NormalLaw::exact_flow, 3, 3, 1), options_of(NormalLaw::exact_flow, 0.01));
  GrainSimulation other(busy_box(NormalLaw::exact_flow, 3, 2, 1), options_of(NormalLaw::exact_flow, 0.01));
  const Bits before = bits_of(other);
  CHECK_THROWS_WITH(other.restore(one.save()),
                    Catch::Contains("the state is of 9 grains") && Catch::Contains("the scene has 6"));
  CHECK(bits_of(other) == before);
  SavedState damaged = other.save();
  damaged["contacts"].push_back(1);
  CHECK_THROWS_AS(other.restore(damaged), Error);
  CHECK(bits_of(other) == before);
}

TEST_CASE("a_saved_contact_of_what_the_scene_lacks_is_refused") {
  GrainSimulation simulation(busy_box(NormalLaw::linear_dashpot, 3, 3, 22),
                             options_of(NormalLaw::linear_dashpot, 0.01));
  simulation.advance(40);
  const Bits before = bits_of(simulation);
  REQUIRE(!simulation.save()["contacts"].empty());
  for (const double body : {-1.0, 9.0, 0.5, 1e300, std::nan("")}) {
    SavedState damaged = simulation.save();
    damaged["contacts"][0] = body;
    CAPTURE(body);
    CHECK_THROWS_AS(simulation.restore(damaged), Error);
    CHECK(bits_of(simulation) == before);
  }
}
