// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Loads on discs as the right-hand side of statics.
#pragma once

#include <span>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/linear/degrees_of_freedom.hpp"
#include "equidem/statics/supports.hpp"

namespace equidem {

/// Force on every component: N/m; moments over a.
/// \throws Error (bad_input) where a load names no group or an empty one, is not finite, is a traction on a group that
///         is no side, or is a moment where rotations are no unknowns
std::vector<double> assemble_loads(const Assembly& assembly, const DegreesOfFreedom& unknowns, const LoadCase& loads);
/// \param loads one for each disc
std::vector<double> assemble_loads(const DegreesOfFreedom& unknowns, std::span<const DiscForce> loads);

/// \throws Error (bad_input) where a moment acts on a disc that neither a contact nor a support keeps from turning:
///         nothing could balance it
void check_inert_loads(const Assembly& assembly, const DegreesOfFreedom& unknowns, std::span<const double> f);

}  // namespace equidem
