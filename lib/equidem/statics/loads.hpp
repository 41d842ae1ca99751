// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Loads as forces on the components of discs.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/linear/contact_graph.hpp"
#include "equidem/statics/supports.hpp"

namespace equidem {

/// Whether the points of three contacts, of which each shares a disc with the next, lie in line: the sine of the angle
/// between the two chords is at most 1e-6.
bool points_in_line(const Assembly& assembly, const std::array<std::size_t, 3>& contacts);

/// Force on every component: N/m; moments over a.
/// \throws Error (bad_input) where a load is not finite, names no group or an empty one, is a traction on a group that
///         is no side, or gives a moment where rotations are no unknowns
std::vector<double> assemble_loads(const Assembly& assembly, const DegreesOfFreedom& unknowns, const LoadCase& loads);
/// \param loads one for each disc
std::vector<double> assemble_loads(const DegreesOfFreedom& unknowns, std::span<const DiscForce> loads);

/// Adds one load to these forces.
/// \param discs its group, or that part of it which belongs to the discs of `f`
/// \param count discs of the whole group
/// \throws Error (bad_input)
void add_load(const Load& load, const DiscGroup& discs, std::int64_t count, const DegreesOfFreedom& unknowns,
              std::span<double> f);

/// Refuses a moment on a disc that no contact keeps from turning, and no support either: it could not be balanced.
/// \throws Error (bad_input)
void check_inert_loads(const Assembly& assembly, const DegreesOfFreedom& unknowns, std::span<const double> f);

}  // namespace equidem
