// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Files that ParaView and VTK's own readers open.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "equidem/output/files/state.hpp"

namespace equidem {

/// Write NAME.vtm, the index to open, and beside it NAME_discs.vtp and NAME_contacts.vtp (VTK XML PolyData, appended
/// raw binary, Float64). SI units; arrays of what the state does not know are left out.
///   discs     one vertex each at its centre: radius, cell_area, displacement (3-vector), rotation, stress_xx,
///   stress_yy,
///             stress_xy, stress_yx, mean_stress. In ParaView: Glyph with the 2D glyph "circle" scaled by radius, or
///             Point Gaussian.
///   contacts  one line each along its branch vector from the centre of i, also where that leads through the period: i,
///   j,
///             branch_length, normal_force (tension positive), tangential_force; and at its ends the displacement of i
///             and j and a radius of zero, so that "Warp By Vector" bends both files alike and Glyph draws circles of
///             discs only.
/// \return the three paths, the index first
/// \throws Error (bad_input) as write_file does, before anything is written where one of the three exists
std::vector<std::filesystem::path> write_vtk(const std::filesystem::path& folder, const std::string& name,
                                             const AssemblyState& state, bool overwrite);

}  // namespace equidem
