// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/core/file.hpp"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <csignal>
#include <cstring>
#include <fstream>
#include <iterator>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "equidem/core/error.hpp"
#include "equidem/core/given.hpp"
#include "equidem/core/memory.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

namespace fs = std::filesystem;

fs::path folder_of(const fs::path& path) {
  return path.has_parent_path() ? path.parent_path() : fs::path(".");
}

/// A device, a pipe or a link: written into. A file of its name would replace it, even /dev/null.
bool is_kept(const fs::path& path) {
  std::error_code ignored;
  return fs::exists(path, ignored) && !fs::is_regular_file(fs::symlink_status(path, ignored));
}

constexpr std::string_view temporary_begin = ".equidem.", temporary_end = ".part";

/// End of the name of a temporary file of this process.
std::string temporary_suffix() {
  return fmt::format("{}{}{}", temporary_begin, getpid(), temporary_end);
}

/// Whether temporary_suffix() of a process that has ended is the end of a name.
bool is_abandoned(std::string_view name) {
  const std::size_t begin = name.rfind(temporary_begin);
  if (begin == std::string_view::npos || !name.ends_with(temporary_end)) return false;
  const char* const number = name.data() + begin + temporary_begin.size();
  const char* const end = name.data() + name.size() - temporary_end.size();
  pid_t process = 0;
  const auto read = std::from_chars(number, end, process);
  return read.ec == std::errc() && read.ptr == end && process > 0 && kill(process, 0) != 0 && errno == ESRCH;
}

[[noreturn]] void cannot_write(const fs::path& path, const std::string& reason) {
  bad_input(fmt::format("cannot write '{}'", path.string()), reason, "Choose a place that can be written to");
}

/// A disk that is full or broken is no fault of what was asked for.
[[noreturn]] void cannot_write(const fs::path& path, int error, const std::string& where = {}) {
  const std::string reason = where + std::strerror(error);
  constexpr int of_the_disk[] = {ENOSPC, EDQUOT, EFBIG, EIO};
  if (std::ranges::find(of_the_disk, error) == std::end(of_the_disk)) cannot_write(path, reason);
  computation_failed(fmt::format("cannot write '{}'", path.string()), reason, "Make room on its disk");
}

/// Device and inode: all names of a file share them.
using FileIdentity = std::pair<dev_t, ino_t>;

std::optional<FileIdentity> identity_of(const fs::path& path) {
  struct stat found {};
  if (stat(path.c_str(), &found) != 0 || !S_ISREG(found.st_mode)) return std::nullopt;
  return FileIdentity(found.st_dev, found.st_ino);
}

thread_local const std::vector<fs::path>* inputs = nullptr;

void refuse_input(const fs::path& path) {
  if (inputs == nullptr) return;
  const auto there = identity_of(path);
  if (!there || std::ranges::none_of(*inputs, [&](const fs::path& input) { return identity_of(input) == there; }))
    return;
  bad_input(fmt::format("'{}' is to be replaced, and is an input of the case", path.string()),
            "a result in its place would change what the same command computes the next time",
            "Choose another --out or file name");
}

}  // namespace

ProtectedInputs::ProtectedInputs(std::vector<fs::path> files) : files_(std::move(files)), outer_(inputs) {
  inputs = &files_;
}

ProtectedInputs::~ProtectedInputs() {
  inputs = outer_;
}

void check_readable(const fs::path& path) {
  std::error_code ignored;
  if (!fs::exists(path, ignored)) {
    bad_input(fmt::format("cannot read '{}'", path.string()), "there is no such file", "Check its name and the folder");
  }
  if (fs::is_directory(path, ignored)) {
    bad_input(fmt::format("cannot read '{}'", path.string()), "it is a folder", "Name a file in it");
  }
  if (!fs::is_regular_file(path, ignored)) {
    bad_input(fmt::format("cannot read '{}'", path.string()), "it is no regular file, and reading it might never end",
              "Copy what it holds into a file");
  }
}

std::string read_file(const fs::path& path) {
  if (const auto given = Given<std::string>::find(path)) return *given;
  check_readable(path);
  std::ifstream file(path, std::ios::binary);
  errno = 0;
  std::string content;
  try {
    std::error_code ignored;
    const auto size = fs::file_size(path, ignored);
    if (!ignored) {
      require_memory(static_cast<double>(size), fmt::format("reading '{}' takes at least", path.string()),
                     "Use a machine with more memory, or a smaller file");
      content.resize(size);
      file.read(content.data(), static_cast<std::streamsize>(size));
      content.resize(static_cast<std::size_t>(file.gcount()));
      if (file.eof()) file.clear();
    }
    // A file of /proc states the size 0, and a file may grow meanwhile.
    content.append(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
  } catch (const std::ios_base::failure&) {
    file.setstate(std::ios_base::badbit);  // /proc/self/mem, a broken disk: the buffer throws by itself
  }
  if (!file || file.bad()) {
    bad_input(fmt::format("cannot read '{}'", path.string()), std::strerror(errno != 0 ? errno : EIO),
              "Check that you may read it");
  }
  return content;
}

void check_writable(const fs::path& path, bool overwrite) {
  std::error_code ignored;
  if (path.empty()) bad_input("the name of a file to write is empty", "nothing can be found by it", "Name the file");
  if (fs::is_directory(path, ignored)) cannot_write(path, "it is a folder");
  if (fs::exists(path, ignored) && !overwrite) {
    bad_input(fmt::format("'{}' exists already", path.string()), "nothing of yours is overwritten unasked",
              "Choose another name, or pass --overwrite");
  }
  refuse_input(path);
  if (is_kept(path)) {
    if (access(path.c_str(), W_OK) != 0) cannot_write(path, errno);
    return;
  }
  fs::path folder = folder_of(path);
  while (!fs::exists(folder, ignored) && folder.has_parent_path() && folder != folder.parent_path()) {
    folder = folder.parent_path();
  }
  if (folder.empty() || !fs::exists(folder, ignored)) folder = ".";
  if (!fs::is_directory(folder, ignored)) cannot_write(path, fmt::format("'{}' is not a folder", folder.string()));
  // Some file systems refuse what their permissions allow: try it. Another thread may try the same folder at the same
  // time.
  const fs::path trial = folder / temporary_suffix();
  if (mkdir(trial.c_str(), 0700) != 0 && errno != EEXIST)
    cannot_write(path, errno, fmt::format("'{}': ", folder.string()));
  fs::remove(trial, ignored);
}

Replacement::Replacement(fs::path path) : path_(std::move(path)), part_(path_.string() + temporary_suffix()) {}

Replacement::~Replacement() {
  std::error_code ignored;
  fs::remove(part_, ignored);
}

void Replacement::commit() {
  std::error_code failed;
  fs::rename(part_, path_, failed);
  if (failed) cannot_write(path_, failed.value());
}

void write_file(const fs::path& path, std::string_view content, bool overwrite) {
  write_file(
      path, [&](const TextSink& to) { to(content); }, overwrite);
}

void write_file(const fs::path& path, const std::function<void(const TextSink&)>& make, bool overwrite) {
  check_writable(path, overwrite);
  std::error_code failed;
  fs::create_directories(folder_of(path), failed);
  if (failed) cannot_write(path, failed.value());
  std::optional<Replacement> replacement;
  if (!is_kept(path)) replacement.emplace(path);
  errno = 0;
  std::ofstream file(replacement ? replacement->path() : path, std::ios::binary | std::ios::trunc);
  const auto check = [&] {
    if (!file) cannot_write(path, errno == 0 ? EIO : errno);
  };
  check();
  make([&](std::string_view part) {
    errno = 0;
    file.write(part.data(), static_cast<std::streamsize>(part.size()));
    check();
  });
  errno = 0;
  file.close();
  check();
  if (replacement) replacement->commit();
}

void remove_abandoned_files(const fs::path& folder) {
  std::error_code ignored;
  std::vector<fs::path> abandoned;
  for (fs::directory_iterator entry(folder, ignored), end; !ignored && entry != end; entry.increment(ignored)) {
    if (is_abandoned(entry->path().filename().string())) abandoned.push_back(entry->path());
  }
  for (const fs::path& path : abandoned) fs::remove(path, ignored);
}

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
