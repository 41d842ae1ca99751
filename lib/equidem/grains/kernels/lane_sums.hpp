// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Sums over the contacts of a vectorized loop in a step.
#pragma once

#include <algorithm>

#include "equidem/grains/grain_system.hpp"
#include "equidem/grains/kernels/pair_lanes.hpp"

namespace equidem::eight {

template <class Lanes>
struct LaneSums {
  /// Losses: normal dashpot, slip, tangential dashpot. Summed contact by contact, so that pairs apart do not change the
  /// result.
  Row<Lanes> lost{};
  double without_friction = 0;  ///< losses of normal dashpots in loops without friction
  double released = 0;          ///< by contacts that ended
  Lanes deepest{};
  Bits<Lanes> evaluations{}, begun{};
};

/// Add the losses of eight contacts.
template <class Lanes>
EQUIDEM_ALWAYS_INLINE void add_losses(const Lanes& normal, const Lanes& slip, const Lanes& dashpot,
                                      LaneSums<Lanes>& sums) {
  Row<Lanes> row[8];
  rows_of(normal, slip, dashpot, Lanes{}, row);
  for (const Row<Lanes>& lost : row) sums.lost += lost;
}
/// Add the losses of eight contacts without friction.
template <class Lanes>
EQUIDEM_ALWAYS_INLINE void add_losses(const Lanes& normal, LaneSums<Lanes>& sums) {
  sums.without_friction = add_up(normal, sums.without_friction);
}
/// Add the energy that the tangential springs of contacts that ended held.
template <class Lanes>
EQUIDEM_ALWAYS_INLINE void add_release(const Lanes& energy, LaneSums<Lanes>& sums) {
  sums.released = add_up(energy, sums.released);
}

template <class Lanes>
EQUIDEM_ALWAYS_INLINE void add(const LaneSums<Lanes>& sums, BlockSums& block) {
  double lost[4];
  PairLanes deepest;
  std::int64_t evaluations[lanes_of_pairs], begun[lanes_of_pairs];
  store(sums.lost, lost);
  store(sums.deepest, deepest);
  store(sums.evaluations, evaluations);
  store(sums.begun, begun);
  block.lost.lost_dashpot += lost[0] + sums.without_friction;
  block.lost.lost_slip += lost[1];
  block.lost.lost_tangential_dashpot += lost[2];
  block.lost.lost_release += sums.released;
  for (std::size_t k = 0; k < lanes_of_pairs; ++k) {
    block.evaluations += evaluations[k];
    block.contacts += begun[k];
    block.deepest = std::max(block.deepest, deepest[k]);
  }
}

}  // namespace equidem::eight
