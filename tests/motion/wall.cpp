// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/motion/wall.hpp"

#include <cmath>

#include "support/catch.hpp"

using namespace equidem;

// The mean of a servo decays by the share of a step: after n steps at an error e it is e (1 - (1 - share)^n).
TEST_CASE("the_overshoot_of_a_servo_is_a_mean_that_follows_a_lasting_error") {
  constexpr double wanted = 100, error = 0.2;
  const double share = GENERATE(0.05, 0.5, 1.0);
  ControlState state;
  state.wanted = state.present = wanted;
  state.count(true, share);
  REQUIRE(state.reached);
  state.present = (1 + error) * wanted;
  for (int steps = 1; steps <= 40; ++steps) {
    state.count(true, share);
    CAPTURE(share, steps);
    CHECK(state.report().overshoot == Approx(error * (1 - std::pow(1 - share, steps))).epsilon(1e-13));
    CHECK(state.report().peak == Approx(error).epsilon(1e-13));
    CHECK(state.report().mean_error == Approx(error * steps / (steps + 1)).epsilon(1e-13));
  }
  state.count_anew();
  CHECK(std::isnan(state.report().overshoot));
}
