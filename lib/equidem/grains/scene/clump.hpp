// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Clumps: from discs anywhere to a body with mass, centre and moment of inertia.
#pragma once

#include <vector>

#include "equidem/grains/scene/grain_scene.hpp"
#include "equidem/material/inertia.hpp"

namespace equidem {

/// The same discs shifted so that the centre of mass of the area they cover together is the origin.
/// \param discs anywhere, overlapping or not
/// \throws Error (bad_input) on no discs, a radius that is not positive, numbers that are not finite, a disc within
///         another
Clump centred_clump(std::vector<Clump::Disc> discs);

/// Of the area that the discs cover together, what several cover once, about its own centre. Exact: an integral along
/// its edge. \param density kg/m³
/// \throws Error (bad_input) where the density is not positive and finite
Inertia inertia_of_clump(const Clump& clump, double density);

/// Of the circle round the origin that holds all discs, m.
double radius_of(const Clump& clump);

}  // namespace equidem
