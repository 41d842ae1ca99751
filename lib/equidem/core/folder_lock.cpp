// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/core/folder_lock.hpp"

#include <cerrno>
#include <cstring>
#include <string>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include "equidem/core/error.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/text.hpp"

namespace equidem {

FolderLock::FolderLock(const std::filesystem::path& folder) {
  std::error_code ignored;
  for (std::filesystem::path missing = folder; !missing.empty() && !std::filesystem::exists(missing, ignored);
       missing = missing.parent_path()) {
    if (missing.has_filename()) made_.push_back(missing);
  }
  std::filesystem::create_directories(folder, ignored);
  descriptor_ = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor_ < 0) {
    const std::string reason = std::strerror(errno);
    bad_input(fmt::format("cannot open the folder '{}'", folder.string()), reason, "Check its name and your rights");
  }
  if (flock(descriptor_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
    close(descriptor_);
    bad_input(fmt::format("the folder '{}' is in use", folder.string()),
              "another process of equidem writes there, and the files of two would mix",
              "Wait until it has ended, or choose another folder");
  }
  remove_abandoned_files(folder);
}

FolderLock::~FolderLock() {
  if (descriptor_ < 0) return;
  for (const std::filesystem::path& folder : made_) {
    if (rmdir(folder.c_str()) != 0) break;  // something is in it
  }
  close(descriptor_);
}

FolderLock::FolderLock(FolderLock&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)), made_(std::move(other.made_)) {}

}  // namespace equidem
