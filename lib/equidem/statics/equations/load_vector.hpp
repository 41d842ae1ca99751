// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Loads as forces on the components of the motion.
#pragma once

#include <span>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/linear/degrees_of_freedom.hpp"
#include "equidem/statics/supports.hpp"

namespace equidem {

/// Force on every component, held ones included: N/m; moments over a.
/// \throws Error (bad_input) where a load is not finite, names no group or an empty one, is a traction on a group that
///         is no side, or gives a moment where rotations are no unknowns
std::vector<double> load_vector(const Assembly& assembly, const DegreesOfFreedom& unknowns, const LoadCase& loads);
/// \param loads one for each disc
std::vector<double> load_vector(const DegreesOfFreedom& unknowns, std::span<const DiscForce> loads);

/// A moment on a disc that no contact keeps from turning, and no support either, could not be balanced.
/// \throws Error (bad_input) naming the disc
void check_inert_loads(const Assembly& assembly, const DegreesOfFreedom& unknowns, std::span<const double> f);

}  // namespace equidem
