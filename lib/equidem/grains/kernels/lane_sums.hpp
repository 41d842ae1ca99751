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

EQUIDEM_ALWAYS_INLINE void add(const LaneSums& sums, BlockSums& block) {
  block.lost.lost_dashpot += sums.lost[0];
  block.lost.lost_slip += sums.lost[1];
  block.lost.lost_tangential_dashpot += sums.lost[2];
  block.lost.lost_release += sums.lost[3];
  for (int k = 0; k < 8; ++k) {
    block.evaluations += sums.evaluations[k];
    block.contacts += sums.begun[k];
    block.deepest = std::max(block.deepest, sums.deepest[k]);
  }
}

}  // namespace equidem::eight
