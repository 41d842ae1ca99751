// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The datasets of an assembly file (HDF5), which reading and writing share.
/// Assemblies from and to HDF5 files: the keys of the JSON file as datasets, in the same units. docs/file_formats.md
/// has their shapes. read_assembly and write_assembly (files.hpp) choose the format by the name of the file.
#pragma once

#include <cstddef>
#include <filesystem>

#include "equidem/assembly/assembly.hpp"

namespace equidem::hdf5_columns {

/// A dataset with a row of `width` numbers for each of something; width 0: one number each, in a list.
struct Column {
  const char* name;
  std::size_t width;
  const char* unit;
};

inline constexpr Column cell = {"cell", 0, "m"}, box = {"box", 2, "m"}, discs = {"discs", 3, "m"},
                        sections = {"sections", 2, "m2, m4"}, contacts = {"contacts", 4, ""},
                        levers = {"levers", 2, "m"}, normals = {"normals", 2, "1"}, offsets = {"offsets", 2, "m"},
                        cell_areas = {"cell_areas", 0, "m2"}, facet_lengths = {"facet_lengths", 0, "m"};
/// All but those of ContactNumbers.
inline constexpr Column all_columns[] = {cell,   box,     discs,   sections,   contacts,
                                         levers, normals, offsets, cell_areas, facet_lengths};

constexpr Column column_of(const ContactNumbers& numbers) {
  return {numbers.key, 2, numbers.unit};
}

/// Rows that are read or written at once: a piece of some hundred KB.
inline constexpr std::size_t rows_at_once = 1 << 16;

}  // namespace equidem::hdf5_columns

namespace equidem {

/// Whether the name of a file ends in .h5 or .hdf5.
bool is_hdf5_name(const std::filesystem::path& path);

/// Everything that the file holds comes back to the last bit. Cells are measured where it has no cell areas and facet
/// lengths, and the sides of a free assembly where it lacks one.
/// \throws Error (bad_input) as read_assembly, the place being the dataset
Assembly read_hdf5_assembly(const std::filesystem::path& path, double gap_tolerance);

/// Write the file whole or not at all: beside its place, then renamed. An existing file is replaced. Missing folders
/// are made. Precondition: the assembly passes check().
/// \throws Error (bad_input) where the file cannot be written (with the reason), or a group has a name that HDF5 cannot
///         store
void write_hdf5_assembly(const std::filesystem::path& path, const Assembly& assembly);

}  // namespace equidem
