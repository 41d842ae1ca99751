// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Contacts among eight pairs that begin or end within a drift (touch_instants.hpp).
#pragma once

#include "equidem/grains/grain_system.hpp"
#include "equidem/grains/kernels/pair_lanes.hpp"

namespace equidem::eight {

/// As TouchInstant; of what ends, and is not said otherwise, the numbers of the instant before.
struct TouchLanes {
  Choice begun, ended, slides;
  const std::int32_t *i, *j;  ///< eight bodies each
  Lanes nx, ny, arm_i_x, arm_i_y, arm_j_x, arm_j_y;
  Lanes closing, slip;             ///< means over the drift
  Lanes deep, spring, impulse;     ///< of the spring, and in all along the normal
  Lanes dashpot, mobility, least;  ///< as in PairGroup and PairLaws; 1/m_i + 1/m_j
  Lanes tangential, tangential_dashpot, stored;
};

void count_instants(GrainSystem& system, const TouchLanes& lanes);

}  // namespace equidem::eight
