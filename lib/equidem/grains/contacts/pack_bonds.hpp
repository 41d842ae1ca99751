// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Bonds in groups of eight for the loops over them.
#pragma once

#include "equidem/contact/viscous_bond.hpp"

namespace equidem {

struct GrainSystem;
struct TiedPair;

/// Pack the bonds of the system, with no impulse in the last step.
void pack_bonds(GrainSystem& system);

/// Take the images of bonds again.
void pack_images(GrainSystem& system);

/// Impulse of the dashpots of a bond in the last step.
BondModes last_impulse(const GrainSystem& system, const TiedPair& bond);
void take_last_impulse(GrainSystem& system, const TiedPair& bond, const BondModes& impulse);

}  // namespace equidem
