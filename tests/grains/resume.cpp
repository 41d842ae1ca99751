// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A run that was saved goes on as if it had never stopped.
#include "grains/resuming.hpp"
#include "grains/scenes.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

TEST_CASE("a_run_saved_at_any_step_goes_on_with_the_same_bits") {
  const Stepping stepping = GENERATE(from_range(all_steppings));
  CAPTURE(stepping.name());
  check_resuming(busy_box(stepping.law, 3, 3, 21), options_of(stepping, 0.01), 120);
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
