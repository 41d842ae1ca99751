// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Assemblies from and to HDF5 files: the keys of the JSON file as datasets, in the same units. docs/file_formats.md
/// has their shapes. read_assembly and write_assembly (files.hpp) choose the format by the name of the file.
#pragma once

#include <filesystem>

#include "equidem/assembly/assembly.hpp"

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
