// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Assemblies from and to files (schema "equidem-assembly/1"): HDF5 where the name ends in .h5 or .hdf5, else JSON; and
/// packings of other programs, which are read.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "equidem/assembly/assembly.hpp"
#include "equidem/core/names.hpp"
#include "equidem/core/vector.hpp"

namespace equidem {

enum class AssemblyFormat { json, hdf5 };

template <>
struct EnumNames<AssemblyFormat> {
  static constexpr const char* what = "format of an assembly file";
  static constexpr NamedValue<AssemblyFormat> list[] = {{AssemblyFormat::json, "json"}, {AssemblyFormat::hdf5, "hdf5"}};
};

/// "assembly.json" or "assembly.h5".
std::string assembly_file_name(const std::string& stem, AssemblyFormat format);

/// The plane that the sample of another program lies in; the second axis becomes y, the upward one.
enum class SamplePlane { xy, xz, yz };

template <>
struct EnumNames<SamplePlane> {
  static constexpr const char* what = "plane of a sample";
  static constexpr NamedValue<SamplePlane> list[] = {
      {SamplePlane::xy, "x-y"}, {SamplePlane::xz, "x-z"}, {SamplePlane::yz, "y-z"}};
};

/// Settings for what a file does not say. All but the gap tolerance are for files of other programs.
struct AssemblyFileOptions {
  double gap_tolerance = 0;  ///< largest gap that is bonded, of the sum of the radii, without contacts in the file
  std::string unit_of_length = {};                     ///< "mm", "2.5 mm"; empty: the file says it
  std::optional<std::int64_t> frame = {};              ///< time step in a LAMMPS dump; none: its last
  std::optional<std::filesystem::path> contacts = {};  ///< table of contacts, in the plane of the sample
  SamplePlane plane = SamplePlane::xy;                 ///< of the columns, or the LAMMPS file
  std::optional<bool> periodic_box = {};               ///< whether the box of a LAMMPS file is the periodic cell
  std::optional<Vec2> period = {};                     ///< m, the cell where the file has no box; none: free
};

/// Read an assembly, or copy the Given<Assembly> of that name. As JSON: `contacts` missing: those of touching_discs, at
/// least one. The contact point of given ones is the midpoint of the branch unless "levers": [[r_i, r_j], ...] is given
/// (see Contact); off the line of centres "normals": [[n_x, n_y], ...] and "offsets": [[o_i, o_j], ...] give its place
/// (see ContactArms); "springs": [[kN, kT], ...] per contact, "strengths": [[f_t, f_s], ...] in N/m likewise, "forces":
/// [[N, T], ...] in N/m those that contacts carry at rest, "curvatures": [[kappa_i, kappa_j], ...] in 1/m of their
/// surfaces; "sections": [[area, polar moment], ...] in m² and m⁴ of bodies that are no discs, each then with the
/// radius of the disc of equal area; "box": [[x, y], [x, y]], the lower left and the upper right corner of what the
/// cells of a free assembly fill, with the direction of the lower side as a third pair where it is turned, else the
/// rectangle of least area that holds all discs; "groups": {"name": [disc, ...]}. Cells ("cell_areas",
/// "facet_lengths"), sides (left, right, bottom, top) and corners are measured where the file gives none: the discs
/// whose cells reach a side (measured_sides). A LAMMPS data file or dump, a text export of YADE and a
/// table with the columns x, y and radius are recognised by their first lines: particle_rows.hpp.
/// \throws Error (bad_input) with file and, where there is one, the entry: unreadable or truncated file, missing or
///         unknown key,
///         wrong type, absent disc, non-finite number, ...; a gap tolerance above 0 beside contacts
Assembly read_assembly(const std::filesystem::path& path, const AssemblyFileOptions& options = {});

/// The text of an assembly file, with all that read_assembly reads, to the same bits.
std::string json_of(const Assembly& assembly);
/// Write all that read_assembly reads, to the same bits. A file is written whole or not at all.
void write_assembly(const std::filesystem::path& path, const Assembly& assembly, bool overwrite);

}  // namespace equidem
