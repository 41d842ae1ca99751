// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Bonds of discs in a step (contact/viscous_bond.hpp): what they push, how long the step may be, how far they drift.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "equidem/contact/finite_bond.hpp"
#include "equidem/contact/viscous_bond.hpp"
#include "equidem/grains/grain_simulation.hpp"
#include "equidem/grains/scene/grain_scene.hpp"

namespace equidem {

struct GrainSystem;

/// A bond between bodies in the order of their places.
struct TiedPair {
  std::int32_t i = 0, j = 0;  ///< i < j
  BondModes dashpots;
  double share = 0;    ///< of lever i in the distance: r_i/(r_i + r_j)
  FiniteBond springs;  ///< between the discs as they are at the start
  std::int32_t packed =
      -1;             ///< place among those that go by eights (bond_loop.hpp), which keep the impulse; -1: not packed
  BondModes impulse;  ///< of the last step
  // in the step being made
  ContactFrame frame;
  BondModes rate, gained;

  [[nodiscard]] bool has_springs() const { return springs.springs.kN > 0 || springs.springs.kT > 0; }
};

/// The bonds of a scene that has been put in order; sorted, so that the caller's order changes no bit.
void tie_bonds(GrainSystem& system, const GrainScene& scene);

/// Centres nearer than this, of the sum of the radii, no longer say which way a bond lies.
constexpr double nearest_centres_of_bonds = 1e-3;

/// \throws Error (computation_failed) that tells of the first bond whose discs are so near
void refuse_crept_bonds(const GrainSystem& system);

/// Whether two bodies i < j are bonded; `next` goes on from call to call while pairs are asked for in ascending order.
inline bool are_tied(const std::vector<TiedPair>& bonds, std::size_t& next, std::int32_t i, std::int32_t j) {
  while (next < bonds.size() && (bonds[next].i < i || (bonds[next].i == i && bonds[next].j < j))) ++next;
  return next < bonds.size() && bonds[next].i == i && bonds[next].j == j;
}

/// Add to the impulses of the step what bonds give, when all contacts have given theirs.
/// \throws Error (computation_failed) where bonded discs have crept into one another until their centres all but meet
void add_bond_impulses(GrainSystem& system);

/// The Verlet schemes: count what dashpots take in the half kick that opens a step; add_bond_impulses counts that which
/// closes one.
void count_opening_kick(GrainSystem& system);

/// Energy of the springs of bonds.
double elastic_of_bonds(const GrainSystem& system);

/// Longest stable step, s; infinite where there is none. Sums over the bonds of each disc of the largest rate of each
/// bond bound M^-1 C and M^-1 K: exact for pairs of discs and for long chains of equal ones, else on the safe side.
/// Dashpots count where they are explicit: dt < 2 m_n/C_n, 2 m_s/C_s of a pair. Contacts with other bodies are not in
/// it.
double bond_step_limit(const GrainScene& scene, GrainOptions::BondStep bond_step);

/// \throws Error (bad_input): bodies that are not there, no discs, tied to themselves or twice to one another, centres
///         that coincide,
///         dashpots and springs that are negative, not finite or all 0, a law that knows no bonds, a step past the
///         limit
void check_bonds(const GrainScene& scene, const GrainOptions& options);

}  // namespace equidem
