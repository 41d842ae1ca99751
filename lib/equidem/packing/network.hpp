// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A packing as a network of contacts with springs: what statics takes.
#pragma once

#include <cstdint>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/material/spring_constants.hpp"
#include "equidem/packing/packing.hpp"

namespace equidem {

/// \throws Error (bad_input) on bodies other than discs: an assembly has its contacts on the lines of centres, theirs are elsewhere
void check_network(const GrainPacking& packing);

/// The discs and the contacts between them with the springs given, levers in proportion to the radii.
Assembly network_of(const GrainPacking& packing, const SpringConstants& springs);

/// What walls hold.
struct HeldNetwork {
  /// Each contact with a wall is one with a disc that mirrors it behind the wall; these are the group "walls": held, they resist as
  /// the wall does. Discs with fewer than two contacts, which could roll, are left out one after the other.
  Assembly assembly;
  std::vector<std::int32_t> discs;  ///< of the packing: the first of the assembly
};
HeldNetwork held_network_of(const GrainPacking& packing, const SpringConstants& springs);

/// How statics sees a packing at rest.
struct RestConfirmation {
  double mean_overlap = 0;    ///< m
  double largest_motion = 0;  ///< m: how far a disc moves under what its weight and contact forces lack
  double residual = 0;        ///< relative, of the solution
  std::int64_t left_out = 0;  ///< discs with fewer than two contacts
  [[nodiscard]] double share() const { return largest_motion / mean_overlap; }
};

/// Put the unbalanced forces of a settled packing on its network and solve.
/// \throws Error as EquilibriumSolver
RestConfirmation confirm_rest(const GrainPacking& packing, const SettlingOptions& options);

}  // namespace equidem
