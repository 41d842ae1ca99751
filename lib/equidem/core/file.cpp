// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/core/file.hpp"

#include <cerrno>
#include <charconv>
#include <csignal>
#include <cstring>
#include <fstream>
#include <iterator>
#include <system_error>
#include <vector>

#include <sys/stat.h>
#include <unistd.h>

#include "equidem/core/error.hpp"
#include "equidem/core/given.hpp"
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

}  // namespace

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
    content.assign(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
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
  if (is_kept(path)) {
    if (access(path.c_str(), W_OK) != 0) cannot_write(path, std::strerror(errno));
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
    cannot_write(path, fmt::format("'{}': {}", folder.string(), std::strerror(errno)));
  fs::remove(trial, ignored);
}

void write_file(const fs::path& path, std::string_view content, bool overwrite) {
  check_writable(path, overwrite);
  std::error_code failed;
  fs::create_directories(folder_of(path), failed);
  if (failed) cannot_write(path, failed.message());
  const auto write_to = [&](const fs::path& place) {
    std::ofstream file(place, std::ios::binary | std::ios::trunc);
    file.write(content.data(), static_cast<std::streamsize>(content.size()));
    file.flush();
    return file ? std::string() : std::string(std::strerror(errno));
  };
  if (is_kept(path)) {
    if (const std::string reason = write_to(path); !reason.empty()) cannot_write(path, reason);
    return;
  }
  const fs::path temporary = path.string() + temporary_suffix();
  if (const std::string reason = write_to(temporary); !reason.empty()) {
    fs::remove(temporary, failed);
    cannot_write(path, reason);
  }
  fs::rename(temporary, path, failed);
  if (failed) {
    const std::string reason = failed.message();
    fs::remove(temporary, failed);
    cannot_write(path, reason);
  }
}

void remove_abandoned_files(const fs::path& folder) {
  std::error_code ignored;
  std::vector<fs::path> abandoned;
  for (fs::directory_iterator entry(folder, ignored), end; !ignored && entry != end; entry.increment(ignored)) {
    if (is_abandoned(entry->path().filename().string())) abandoned.push_back(entry->path());
  }
  for (const fs::path& path : abandoned) fs::remove(path, ignored);
}

}  // namespace equidem
