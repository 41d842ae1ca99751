// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Files that are written in place while a computation goes on.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>

namespace equidem {

/// An open file. A write goes straight to the operating system: what was written stays, also where the process is
/// killed the moment after; where the machine itself may fail, sync().
class OpenFile {
 public:
  enum class Mode {
    read,    ///< an existing file
    update,  ///< an existing file, to be changed
    create,  ///< empty; an existing file loses its content
  };

  /// \throws Error (bad_input) where it cannot be opened
  OpenFile(std::filesystem::path path, Mode mode);
  ~OpenFile();
  OpenFile(OpenFile&& other) noexcept;
  OpenFile& operator=(OpenFile&& other) noexcept;
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;

  /// \throws Error (computation_failed) where not all of it could be written: a full disk
  void write_at(std::uint64_t offset, std::span<const std::byte> bytes);
  /// \throws Error (bad_input) where the file ends before
  void read_at(std::uint64_t offset, std::span<std::byte> bytes) const;
  [[nodiscard]] std::uint64_t size() const;
  void truncate(std::uint64_t bytes);
  /// Return once all that was written is on the disk.
  void sync();

 private:
  std::filesystem::path path_;
  int descriptor_ = -1;
};

/// A file in the making that will take the place of another at once: whoever opens that finds the old or the new one.
class Replacement {
 public:
  explicit Replacement(std::filesystem::path path);
  /// Removes what was made and not committed.
  ~Replacement();
  Replacement(const Replacement&) = delete;
  Replacement& operator=(const Replacement&) = delete;

  /// Where to make it: the name to be taken and ".part".
  [[nodiscard]] const std::filesystem::path& path() const { return part_; }
  /// \throws Error (computation_failed) where that fails
  void commit();

 private:
  std::filesystem::path path_, part_;
};

/// Return once the names in the folder of `path` are on the disk.
void sync_folder_of(const std::filesystem::path& path);

}  // namespace equidem
