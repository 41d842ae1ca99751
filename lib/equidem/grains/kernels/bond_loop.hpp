// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Bonds of pairs, eight at a time: dashpots along and across the line of two discs that no other bond ties.
///
/// Where no disc has two bonds, none waits for another: what is done to a bond is known when all contacts have given
/// theirs. Chains, rolling dashpots, and laws without near pairs go one bond after the other (bond_step.cpp).
#pragma once

#include <cstdint>
#include <vector>

#include "equidem/contact/viscous_bond.hpp"
#include "equidem/grains/neighbours/near_pairs.hpp"

namespace equidem {

struct TiedPair;

/// Eight bonds; a lane without one has the bodies of the first and does nothing.
struct alignas(64) BondGroup {
  /// What a body's push, a row of four, adds to its velocity and to the speed of its rim.
  using Row = double[4];

  std::int32_t i[lanes_of_pairs], j[lanes_of_pairs];
  alignas(
      32) Row gain_i[lanes_of_pairs];  ///< velocity: of the opposite sign, so that the sum is the gain of j against i
  Row gain_j[lanes_of_pairs];
  PairLanes radius_i, radius_j;  ///< m
  PairLanes per_reach;           ///< 1/(r_i + r_j), 1/m
  PairLanes mass;                ///< 1/m_n, 1/kg
  PairLanes turning;             ///< r_i²/I_i + r_j²/I_j, 1/kg
  PairLanes normal;              ///< impulse per rate: C_n dt times Decay::mean, or C_n dt by the explicit step, kg
  PairLanes normal_gain;         ///< impulse per gain by steady forces: (1 - Decay::mean) m_n, kg
  PairLanes tangential;          ///< C_s dt, kg
  // of the last step, N s
  PairLanes normal_impulse, tangential_impulse;
};

struct PackedBonds {
  LaneVector<BondGroup> groups;
  std::vector<std::size_t> one_by_one;  ///< the others, ascending
  std::vector<std::size_t> sprung;      ///< of either, ascending

  [[nodiscard]] std::size_t bytes() const {
    return groups.capacity() * sizeof(BondGroup) + (one_by_one.capacity() + sprung.capacity()) * sizeof(std::size_t);
  }
};

/// Pack those bonds of the system that can go by eights.
void pack_bonds(GrainSystem& system);

/// Add what packed bonds give to the impulses, and count what they take; see add_bond_impulses().
void push_packed_bonds(GrainSystem& system);

/// See count_opening_kick().
void count_opening_kick_of_packed_bonds(GrainSystem& system);

/// Impulse that a bond gave in the last step.
BondModes last_impulse(const GrainSystem& system, const TiedPair& bond);
void take_last_impulse(GrainSystem& system, TiedPair& bond, const BondModes& impulse);

}  // namespace equidem
