// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Contacts among eight pairs that begin or end within a drift (touch_instants.hpp).
#pragma once

#include "equidem/grains/grain_system.hpp"
#include "equidem/grains/kernels/pair_lanes.hpp"

namespace equidem::eight {

/// As TouchInstant. For contacts that end, values are those of the instant before unless stated otherwise.
struct TouchLanes {
  Choice begun, ended, slides;
  const std::int32_t *i, *j;  ///< indices of eight bodies each
  Lanes nx, ny, arm_i_x, arm_i_y, arm_j_x, arm_j_y;
  Lanes closing, slip;             ///< means over the drift
  Lanes deep, spring, impulse;     ///< overlap; normal impulse of the spring, and total normal impulse
  Lanes dashpot, mobility, least;  ///< as in PairGroup and PairLaws; 1/m_i + 1/m_j
  Lanes tangential, tangential_dashpot, stored;
};

/// \param block sums of the pairs of its block
void count_instants(const GrainSystem& system, const TouchLanes& lanes, BlockSums& block);

}  // namespace equidem::eight
