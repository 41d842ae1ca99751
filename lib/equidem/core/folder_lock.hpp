// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Lock of a folder against other processes.
#pragma once

#include <filesystem>
#include <vector>

namespace equidem {

/// A folder that one process at a time may write. The kernel releases the lock when the process ends, whatever ends it.
/// Where the file system has no locks for folders (NFS), the folder is not locked.
class FolderLock {
 public:
  /// Missing folders are made, and files that killed processes left half written in it are removed. Folders that were
  /// made and in which nothing was written are removed again with the lock.
  /// \throws Error (bad_input) where the folder is locked already, or where it cannot be opened
  explicit FolderLock(const std::filesystem::path& folder);
  ~FolderLock();
  FolderLock(FolderLock&& other) noexcept;
  FolderLock& operator=(FolderLock&&) = delete;
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  int descriptor_ = -1;
  std::vector<std::filesystem::path> made_;  ///< the innermost first
};

}  // namespace equidem
