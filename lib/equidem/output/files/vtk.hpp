// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Files that ParaView and VTK's own readers open.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "equidem/contact/body_contact.hpp"
#include "equidem/output/files/state.hpp"

namespace equidem {

/// Bodies as the ends of contacts.
struct PlacedBodies {
  std::span<const Vec2> places;              ///< centres, m
  std::span<const DiscMotion> motions = {};  ///< displacement of each from its place; empty: not written
};

/// The PolyData of contacts: a line each from the centre of i to that of j, also where that leads through the period,
/// or to the contact point at a wall. Arrays of lines: i, j (negative: wall -1 - j), contact_point (m), and with
/// `forces` force (3-vector, on i), normal_force, tangential_force (body_contact.hpp); of points: displacement, and a
/// radius of zero, so that Glyph draws circles of discs only.
/// \param time see PolyData::text
std::string contacts_text(const PlacedBodies& bodies, std::span<const BodyContact> contacts, bool forces,
                          const double* time = nullptr);

/// Write NAME.vtm, the index to open, and beside it NAME_discs.vtp and NAME_contacts.vtp (VTK XML PolyData, appended
/// raw binary, Float64). SI units; arrays of what the state does not contain are left out.
///   discs     one vertex each at its centre: radius, cell_area, displacement (3-vector), rotation, stress_xx,
///             stress_yy, stress_xy, stress_yx, mean_stress. In ParaView: Glyph with the 2D glyph "circle" scaled by
///             radius, or Point Gaussian.
///   contacts  as contacts_text: "Warp By Vector" bends both files alike.
/// \return the three paths, the index first
/// \throws Error (bad_input) as write_file does, before anything is written where one of the three exists
std::vector<std::filesystem::path> write_vtk(const std::filesystem::path& folder, const std::string& name,
                                             const AssemblyState& state, bool overwrite);

}  // namespace equidem
