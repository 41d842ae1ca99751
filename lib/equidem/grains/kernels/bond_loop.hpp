// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Bonds of isolated pairs, eight at a time: dashpots along and across the line of two discs without other bonds.
///
/// If no disc has two bonds, bonds are independent: the impulse of a bond follows from those of all contacts. Chains,
/// rolling dashpots, periodic cells, and laws without near pairs are stepped one bond after the other (bond_step.cpp).
#pragma once

#include <cstdint>
#include <vector>

#include "equidem/contact/viscous_bond.hpp"
#include "equidem/grains/neighbours/near_pairs.hpp"

namespace equidem {

struct TiedPair;

/// Eight bonds; an unused lane has the bodies of the first and zero impulse coefficients.
struct alignas(64) BondGroup {
  /// Factors from a body's impulse, a row of four, to the gain of velocity and of rim speed.
  using Row = double[4];

  std::int32_t i[lanes_of_pairs], j[lanes_of_pairs];
  alignas(
      32) Row gain_i[lanes_of_pairs];  ///< velocity with opposite sign, so that the sum is the gain of j relative to i
  Row gain_j[lanes_of_pairs];
  PairLanes radius_i, radius_j;  ///< m
  PairLanes per_reach;           ///< 1/(r_i + r_j), 1/m
  PairLanes mass;                ///< 1/m_n, 1/kg
  PairLanes turning;             ///< r_i²/I_i + r_j²/I_j, 1/kg
  PairLanes normal;              ///< impulse per rate: C_n dt times Decay::mean, or C_n dt by the explicit step, kg
  PairLanes normal_gain;         ///< impulse per velocity gain by steady forces: (1 - Decay::mean) m_n, kg
  PairLanes tangential;          ///< C_s dt, kg
  // of the last step, N s
  PairLanes normal_impulse, tangential_impulse;
};

struct PackedBonds {
  LaneVector<BondGroup> groups;
  std::vector<std::size_t> one_by_one;  ///< bonds with dashpots that are not packed, ascending
  std::vector<std::size_t> sprung;      ///< bonds with springs, packed or not, ascending

  [[nodiscard]] std::size_t bytes() const {
    return groups.capacity() * sizeof(BondGroup) + (one_by_one.capacity() + sprung.capacity()) * sizeof(std::size_t);
  }
};

/// Pack the bonds of the system that can be stepped eight at a time.
void pack_bonds(GrainSystem& system);

/// Add the impulses of packed bonds and count their losses; see add_bond_impulses().
void push_packed_bonds(GrainSystem& system);

/// As count_opening_kick(), for packed bonds.
void count_opening_kick_of_packed_bonds(GrainSystem& system);

/// Impulse of a bond in the last step.
BondModes last_impulse(const GrainSystem& system, const TiedPair& bond);
void take_last_impulse(GrainSystem& system, TiedPair& bond, const BondModes& impulse);

}  // namespace equidem
