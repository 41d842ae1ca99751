// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/core/files/open_file.hpp"

#include <cerrno>
#include <cstring>
#include <string>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

[[noreturn]] void write_failed(const std::filesystem::path& path, const std::string& reason) {
  computation_failed(fmt::format("cannot write '{}'", path.string()), reason,
                     "Make room on its disk; a run goes on from its last checkpoint");
}

}  // namespace

OpenFile::OpenFile(std::filesystem::path path, Mode mode) : path_(std::move(path)) {
  const int flags = mode == Mode::read ? O_RDONLY : mode == Mode::update ? O_RDWR : O_RDWR | O_CREAT | O_TRUNC;
  descriptor_ = open(path_.c_str(), flags | O_CLOEXEC, 0666);
  if (descriptor_ < 0) {
    const std::string reason = std::strerror(errno);
    bad_input(fmt::format("cannot open '{}'", path_.string()), reason, "Check its name, its folder and your rights");
  }
}

OpenFile::~OpenFile() {
  if (descriptor_ >= 0) close(descriptor_);
}

OpenFile::OpenFile(OpenFile&& other) noexcept
    : path_(std::move(other.path_)), descriptor_(std::exchange(other.descriptor_, -1)) {}

OpenFile& OpenFile::operator=(OpenFile&& other) noexcept {
  std::swap(path_, other.path_);
  std::swap(descriptor_, other.descriptor_);
  return *this;
}

void OpenFile::write_at(std::uint64_t offset, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = pwrite(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) write_failed(path_, std::strerror(written == 0 ? ENOSPC : errno));
    bytes = bytes.subspan(static_cast<std::size_t>(written));
    offset += static_cast<std::uint64_t>(written);
  }
}

void OpenFile::read_at(std::uint64_t offset, std::span<std::byte> bytes) const {
  while (!bytes.empty()) {
    const ssize_t read = pread(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (read < 0 && errno == EINTR) continue;
    if (read <= 0) {
      bad_input(fmt::format("cannot read '{}'", path_.string()),
                read == 0 ? fmt::format("it ends after {} bytes", size()) : std::string(std::strerror(errno)),
                "Give the whole file");
    }
    bytes = bytes.subspan(static_cast<std::size_t>(read));
    offset += static_cast<std::uint64_t>(read);
  }
}

std::uint64_t OpenFile::size() const {
  struct stat facts = {};
  return fstat(descriptor_, &facts) == 0 ? static_cast<std::uint64_t>(facts.st_size) : 0;
}

void OpenFile::truncate(std::uint64_t bytes) {
  if (ftruncate(descriptor_, static_cast<off_t>(bytes)) != 0) write_failed(path_, std::strerror(errno));
}

void OpenFile::sync() {
  if (fsync(descriptor_) != 0) write_failed(path_, std::strerror(errno));
}

void OpenFile::sync_file_system() {
  if (syncfs(descriptor_) != 0) write_failed(path_, std::strerror(errno));
}

void sync_folder_of(const std::filesystem::path& path) {
  const std::filesystem::path folder = path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
  OpenFile(folder, OpenFile::Mode::read).sync();
}

void sync_files(const std::vector<std::filesystem::path>& paths) {
  constexpr std::size_t few = 4;
  if (paths.size() > few) return OpenFile(paths.back(), OpenFile::Mode::read).sync_file_system();
  for (const auto& path : paths) {
    OpenFile(path, OpenFile::Mode::read).sync();
    sync_folder_of(path);
  }
}

}  // namespace equidem
