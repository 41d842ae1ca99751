// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// HDF5 files whose arrays have fixed places. The HDF5 library lays a file out once; numbers are then written and read
/// in place, and the structure is not changed again: a program killed while it writes leaves a file that every reader
/// opens. (HDF5 itself rewrites its indices in place as a file grows, and a kill in between can cost the whole file.
/// Limits: arrays cannot grow and are not compressed.)
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace equidem {

enum class Hdf5Number { float64, int64, text };

/// An array of an HDF5 file, in the byte order of this machine, rows together.
struct Hdf5Array {
  std::string name;  ///< "energies"
  Hdf5Number number = Hdf5Number::float64;
  std::vector<std::uint64_t> shape;  ///< text: its one length in bytes
  std::uint64_t offset = 0;          ///< offset of its first byte in the file

  [[nodiscard]] std::uint64_t size() const;  ///< numbers
  [[nodiscard]] std::uint64_t bytes() const;
};

struct Hdf5Layout {
  std::map<std::string, std::string> attributes;  ///< of the file, short texts
  std::vector<Hdf5Array> arrays;
  std::uint64_t user_block = 0;  ///< bytes before the HDF5 part: 0, or a power of two from 512 on

  /// Precondition: the array exists.
  [[nodiscard]] const Hdf5Array& operator[](const std::string& name) const;
};

/// Write a new file with room for all arrays, whose numbers are undefined (on most file systems zero, and room on the
/// disk is taken only as they are written). The same layout gives the same bytes. An existing file is replaced.
/// \return the layout with all offsets
/// \throws Error (computation_failed) where the file cannot be written
Hdf5Layout write_hdf5_layout(const std::filesystem::path& path, Hdf5Layout layout);

/// Offsets of the arrays of those names, and all text attributes of the file.
/// \throws Error (bad_input) where the file is no HDF5 file, lacks one of the arrays, or keeps one in pieces or in a
///         type that is not the one of this machine (as a file does that another program has rewritten)
Hdf5Layout read_hdf5_layout(const std::filesystem::path& path, const std::vector<std::string>& names);

}  // namespace equidem
