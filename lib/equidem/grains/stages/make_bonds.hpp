// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Bonds that are made where a stage begins.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "equidem/breakage/strengths.hpp"
#include "equidem/grains/grain_simulation.hpp"

namespace equidem {

/// Discs are bonded where the gap between them is small.
struct StageBonds {
  double gap_tolerance = 0;  ///< largest gap over the sum of the radii, as in touching_discs
  GrainBond like = {};       ///< with the springs and dashpots of all; i, j and rest are not read
  /// Strengths of the new bonds, in their order; where the bonds of a run break, and only there.
  std::optional<StrengthOptions> strengths = {};
};

/// The new bonds, ordered by i, then j > i. Discs that press each other keep their force: with f_N, f_T the normal
/// (compression positive) and tangential force of the contact, the bond is at rest at |l0| = |l| + f_N/kN, turned by
/// f_T |l|/(kT |l0|²), so that its springs carry what the contact did. A spring that the bond lacks carries nothing.
/// \param scene its bodies, and its periodic cell with the present periods
/// \param contacts of the last step
/// \param known bonds so far, broken ones too: their discs are not bonded again
/// \throws Error (bad_input) where a spring is so soft that it would have to be pressed to half its length, or turned
///         by more than a right angle, to carry the force of the contact
std::vector<GrainBond> make_bonds(const GrainScene& scene, std::span<const GrainContact> contacts,
                                  std::span<const GrainBond> known, const StageBonds& how);

/// \throws Error (bad_input): a grain that is no disc, bonds that no law or step of the options allows, as check_bonds
void check(const StageBonds& bonds, std::span<const Grain> grains, const GrainOptions& options);

/// The step that such bonds are likely to bear, s: that of the lightest disc among six like it. Who is bonded to whom
/// shows only where the stage begins, and a longer step than those bear is refused there.
double likely_step_limit(std::span<const Grain> grains, const StageBonds& bonds, GrainOptions::BondStep bond_step);

}  // namespace equidem
