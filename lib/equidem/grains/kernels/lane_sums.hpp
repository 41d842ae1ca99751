// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Sums over the contacts of a vectorized loop in a step.
#pragma once

#include <algorithm>

#include "equidem/grains/grain_system.hpp"
#include "equidem/grains/kernels/pair_lanes.hpp"

namespace equidem::eight {

struct LaneSums {
  /// Losses: normal dashpot, slip, tangential dashpot, release. Summed contact by contact, so that pairs apart do not
  /// change the result.
  Half lost{};
  Lanes deepest{};
  Choice evaluations{}, begun{};
};

EQUIDEM_ALWAYS_INLINE void add(const LaneSums& sums, GrainSystem& system) {
  system.lost.lost_dashpot += sums.lost[0];
  system.lost.lost_slip += sums.lost[1];
  system.lost.lost_tangential_dashpot += sums.lost[2];
  system.lost.lost_release += sums.lost[3];
  for (int k = 0; k < 8; ++k) {
    system.counters.evaluations += sums.evaluations[k];
    system.counters.contacts += sums.begun[k];
    if (sums.evaluations[k] > 0) system.free_flight = false;
    system.deepest = std::max(system.deepest, sums.deepest[k]);
  }
}

}  // namespace equidem::eight
