// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Clumps: discs tied rigidly, with mass, centre of mass and moment of inertia.
#pragma once

#include <vector>

#include "equidem/grains/scene/grain_scene.hpp"
#include "equidem/material/inertia.hpp"

namespace equidem {

/// The discs, shifted so that the centroid of their union is the origin.
/// \param discs in any position, overlapping or not
/// \throws Error (bad_input) on no discs, a radius that is not positive, numbers that are not finite, a disc within
///         another
Clump centred_clump(std::vector<Clump::Disc> discs);

/// Mass and moment of inertia of the union of the discs about its centroid, exact to rounding.
/// \param density kg/m³
/// \throws Error (bad_input) if the density is not positive and finite
Inertia inertia_of_clump(const Clump& clump, double density);

/// Radius of the circle round the origin that contains all discs, m.
double radius_of(const Clump& clump);

}  // namespace equidem
