// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Files that ParaView and VTK's own readers open.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "equidem/contact/body_contact.hpp"
#include "equidem/output/files/state.hpp"

namespace equidem {

/// Bodies as the ends of contacts.
struct BodyPlaces {
  std::span<const Vec2> places;               ///< centres, m
  std::span<const DiscMotion> motions = {};   ///< displacement of each from its place; empty: not written
  std::span<const std::size_t> numbers = {};  ///< of each, ascending, by which contacts name it; empty: its place here
};

/// Forces and moments of contacts, as far as they are known.
struct ContactLoads {
  bool forces = false, moments = false;
};

/// The PolyData of contacts: a line each from the centre of i to that of j, also where that leads through the period,
/// or to the contact point at a wall. Arrays of lines: i, j (negative: wall -1 - j), contact_point (m), and as `loads`
/// say force (3-vector, on i), normal_force, tangential_force, bending_moment (body_contact.hpp); of points:
/// displacement, and a radius of zero, so that Glyph draws circles of discs only.
/// \param time see PolyData::text
std::string contacts_text(const BodyPlaces& bodies, std::span<const BodyContact> contacts, ContactLoads loads,
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

/// Write one piece of an assembly that several processes hold: NAME_discs_K.vtp and NAME_contacts_K.vtp as write_vtk.
/// Discs have the array `number`, that in the whole assembly; `i` and `j` of contacts count the points of the piece.
/// \param numbers of the discs that are written, the first ones of the state; contacts may reach the others
void write_vtk_piece(const std::filesystem::path& folder, const std::string& name, int piece,
                     const AssemblyState& state, std::span<const std::int64_t> numbers, bool overwrite);
/// The names of these two files.
std::vector<std::string> vtk_piece_names(const std::string& name, int piece);
/// Write NAME.vtm, the index of all pieces: a block of discs and one of contacts.
void write_vtk_index(const std::filesystem::path& folder, const std::string& name, int pieces, bool overwrite);

}  // namespace equidem
