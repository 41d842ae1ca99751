// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Reading and writing whole files, with errors a user can act on.
/// Lock of a folder against other processes.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace equidem {

/// \throws Error (bad_input) where the path leads to no regular file: nothing, a folder, a device or a pipe
void check_readable(const std::filesystem::path& path);

/// The content of a file, or of a Given<std::string> of that name.
/// \throws Error (bad_input) as check_readable, or where the file cannot be read
std::string read_file(const std::filesystem::path& path);

/// A temporary file that replaces another atomically: a reader finds the old or the new file.
class Replacement {
 public:
  explicit Replacement(std::filesystem::path path);
  /// Removes a file that was not committed.
  ~Replacement();
  Replacement(const Replacement&) = delete;
  Replacement& operator=(const Replacement&) = delete;

  /// Name of the temporary file: the final name, that of this process and ".part".
  [[nodiscard]] const std::filesystem::path& path() const { return part_; }
  /// \throws Error as write_file where that fails
  void commit();

 private:
  std::filesystem::path path_, part_;
};

/// Write a file whole or not at all: into a temporary file beside it, then renamed. Missing folders are made. Devices,
/// pipes and links are written into.
/// \throws Error (bad_input) where it exists and `overwrite` is false, or where it cannot be written (with the
///         reason); (computation_failed) where the disk is full or fails
void write_file(const std::filesystem::path& path, std::string_view content, bool overwrite);

/// Takes a text part by part.
using TextSink = std::function<void(std::string_view part)>;
/// Write a content while it is made, as the other write_file does: it is never whole in memory.
/// \param make passes the parts on in their order; what it throws leaves the file as it was
void write_file(const std::filesystem::path& path, const std::function<void(const TextSink&)>& make, bool overwrite);
/// Passes on and clears a text that has grown to a block.
inline void pass_block(std::string& text, const TextSink& to, std::size_t block = 1 << 16) {
  if (text.size() < block) return;
  to(text);
  text.clear();
}

/// Remove the temporary files that processes which have ended since, killed in the middle of write_file, left in a
/// folder (not below it).
void remove_abandoned_files(const std::filesystem::path& folder);

/// Fail early: the error that write_file would give, without writing.
void check_writable(const std::filesystem::path& path, bool overwrite);

/// While one exists, check_writable and write_file refuse to replace these files on its thread, whatever their names.
class ProtectedInputs {
 public:
  explicit ProtectedInputs(std::vector<std::filesystem::path> files);
  ~ProtectedInputs();
  ProtectedInputs(const ProtectedInputs&) = delete;
  ProtectedInputs& operator=(const ProtectedInputs&) = delete;

 private:
  std::vector<std::filesystem::path> files_;
  const std::vector<std::filesystem::path>* outer_;
};

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
