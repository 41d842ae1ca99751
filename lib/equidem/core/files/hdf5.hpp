// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// HDF5 files. Those that this library writes have arrays in fixed places: the HDF5 library lays a file out once;
/// numbers are then written and read in place, and the structure is not changed again: a program killed while it writes
/// leaves a file that every reader opens. (HDF5 itself rewrites its indices in place as a file grows, and a kill in
/// between can cost the whole file. Limits: arrays cannot grow and are not compressed.) Hdf5File reads those that any
/// program wrote.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace equidem {

enum class Hdf5Number { float64, int32, int64, text };

/// An array of an HDF5 file, in the byte order of this machine, rows together.
struct Hdf5Array {
  std::string name;  ///< "energies"
  Hdf5Number number = Hdf5Number::float64;
  std::vector<std::uint64_t> shape;                    ///< text: its one length in bytes
  std::uint64_t offset = 0;                            ///< offset of its first byte in the file
  std::map<std::string, std::string> attributes = {};  ///< short texts; written, not read

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

/// An HDF5 file that any program may have written, open for reading: numbers of any type and byte order, compressed or
/// not.
class Hdf5File {
 public:
  enum class Kind { real, whole, other };
  struct Dataset {
    Kind kind = Kind::other;
    std::vector<std::uint64_t> shape;
  };

  /// \throws Error (bad_input) where the file does not exist, is no HDF5 file, or is truncated or damaged
  explicit Hdf5File(std::filesystem::path path);
  ~Hdf5File();
  Hdf5File(const Hdf5File&) = delete;
  Hdf5File& operator=(const Hdf5File&) = delete;

  /// Text attributes of the file.
  [[nodiscard]] const std::map<std::string, std::string>& attributes() const { return attributes_; }
  /// Names of what a group holds, ascending; "/" is the file itself.
  [[nodiscard]] std::vector<std::string> names(const std::string& group) const;
  [[nodiscard]] bool is_group(const std::string& name) const;
  /// None where there is no dataset of that name.
  [[nodiscard]] std::optional<Dataset> find(const std::string& name) const;
  /// Rows first, first + 1, ... of an existing dataset, as many as fill `values`.
  /// \throws Error (bad_input) where they cannot be read
  void read_rows(const std::string& name, std::uint64_t first, std::span<double> values) const;
  /// Whole numbers beyond 64 bits are read as the nearest that fit.
  void read_rows(const std::string& name, std::uint64_t first, std::span<std::int64_t> values) const;

 private:
  void read_rows_as(std::int64_t type, const std::string& name, std::uint64_t first, std::size_t count,
                    void* values) const;

  std::filesystem::path path_;
  std::int64_t id_ = -1;
  std::map<std::string, std::string> attributes_;
};

}  // namespace equidem
