// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A run saved at any of its steps goes on with the same bits.
#pragma once

#include <vector>

#include "grains/scenes.hpp"
#include "support/catch.hpp"

namespace equidem::test {

inline void check_resuming(const GrainScene& scene, const GrainOptions& options, int last) {
  GrainSimulation whole(scene, options);
  std::vector<SavedState> states;
  std::vector<Bits> seen;
  for (int k = 0; k <= last; ++k) {
    if (k > 0) whole.advance(1);
    states.push_back(whole.save());
    seen.push_back(bits_and_loads_of(whole));
  }
  REQUIRE(whole.counters().contacts > 10);
  const Bits& end = seen.back();
  for (int k = 0; k <= last; ++k) {
    CAPTURE(k, states[static_cast<std::size_t>(k)]["contacts"].size());
    GrainSimulation resumed(scene, options);
    resumed.restore(states[static_cast<std::size_t>(k)]);
    REQUIRE(bits_and_loads_of(resumed) == seen[static_cast<std::size_t>(k)]);
    resumed.advance(last - k);
    REQUIRE(bits_and_loads_of(resumed) == end);
    CHECK(resumed.counters().contacts == whole.counters().contacts);
  }
}

}  // namespace equidem::test
