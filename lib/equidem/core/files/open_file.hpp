// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Files written in place during a computation.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

namespace equidem {

/// An open file. A write goes directly to the operating system, so that data survive a kill of the process; sync()
/// protects against failure of the machine.
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
  /// Sync all written data to disk.
  void sync();
  /// Sync the whole file system.
  void sync_file_system();

 private:
  std::filesystem::path path_;
  int descriptor_ = -1;
};

/// Sync the entries of the folder of `path` to disk.
void sync_folder_of(const std::filesystem::path& path);
/// Sync many files of one file system to disk, with one call for all that was written to it; each alone takes about
/// 10 ms.
void sync_files(const std::vector<std::filesystem::path>& paths);

}  // namespace equidem
