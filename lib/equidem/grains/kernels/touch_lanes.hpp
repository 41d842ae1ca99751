// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Contacts among eight pairs that begin or end within a drift (touch_instants.hpp).
#pragma once

#include "equidem/grains/grain_system.hpp"
#include "equidem/grains/kernels/pair_lanes.hpp"

namespace equidem::eight {

/// As TouchInstant, of each lane. For contacts that end, values are those of the instant before unless stated
/// otherwise. \tparam Lanes eight numbers, or PairLanes \tparam Choices Bits of them, or eight whole numbers
template <class Lanes, class Choices>
struct TouchesOf {
  Choices begun, ended, slides;
  Lanes nx{}, ny{}, arm_i_x{}, arm_i_y{}, arm_j_x{}, arm_j_y{};
  Lanes closing, slip;             ///< means over the drift
  Lanes deep, spring, impulse;     ///< overlap; normal impulse of the spring, and total normal impulse
  Lanes dashpot, mobility, least;  ///< times dt, kg; 1/m_i + 1/m_j; as in PairLaw
  Lanes tangential, tangential_dashpot, stored;
};
template <class Lanes>
using Touches = TouchesOf<Lanes, Bits<Lanes>>;
using StoredTouches = TouchesOf<PairLanes, std::int64_t[lanes_of_pairs]>;

/// \param i,j eight bodies each; j may be images
/// \param block sums of the pairs of its block
void count_instants(const GrainSystem& system, const std::int32_t* i, const std::int32_t* j,
                    const StoredTouches& touches, BlockSums& block);

template <class Lanes>
EQUIDEM_ALWAYS_INLINE void count_instants(const GrainSystem& system, const std::int32_t* i, const std::int32_t* j,
                                          const Touches<Lanes>& touches, BlockSums& block) {
  StoredTouches stored;
  store(touches.begun, stored.begun);
  store(touches.ended, stored.ended);
  store(touches.slides, stored.slides);
  store(touches.nx, stored.nx);
  store(touches.ny, stored.ny);
  store(touches.arm_i_x, stored.arm_i_x);
  store(touches.arm_i_y, stored.arm_i_y);
  store(touches.arm_j_x, stored.arm_j_x);
  store(touches.arm_j_y, stored.arm_j_y);
  store(touches.closing, stored.closing);
  store(touches.slip, stored.slip);
  store(touches.deep, stored.deep);
  store(touches.spring, stored.spring);
  store(touches.impulse, stored.impulse);
  store(touches.dashpot, stored.dashpot);
  store(touches.mobility, stored.mobility);
  store(touches.least, stored.least);
  store(touches.tangential, stored.tangential);
  store(touches.tangential_dashpot, stored.tangential_dashpot);
  store(touches.stored, stored.stored);
  count_instants(system, i, j, stored, block);
}

}  // namespace equidem::eight
