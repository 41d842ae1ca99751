// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/core/turns.hpp"

#include "support/catch.hpp"

using namespace equidem;

TEST_CASE("sine_of_turns_is_the_sine") {
  for (int k = -4000; k <= 4000; ++k) {
    const double x = 1e-3 * k;
    CAPTURE(x, sine_of_turns(x));
    CHECK(std::abs(sine_of_turns(x) - std::sin(2 * std::numbers::pi * x)) < 5e-15);
  }
  CHECK(sine_of_turns(0.25) == 1);
  CHECK(sine_of_turns(3.0) == 0);
}
