// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Files are written whole or not at all, and never over existing ones unless that is asked for.
#include "equidem/core/file.hpp"

#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

#include "support/catch.hpp"
#include "support/fields.hpp"
#include "support/temporary_folder.hpp"

using namespace equidem;
using equidem::test::refusal_of;
using equidem::test::TemporaryFolder;
namespace fs = std::filesystem;

namespace {

/// Files of this process may not grow beyond this many bytes, as on a full disc.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) {
    std::signal(SIGXFSZ, SIG_IGN);
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileSizeLimit() { setrlimit(RLIMIT_FSIZE, &before_); }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;

 private:
  rlimit before_{};
};

}  // namespace

TEST_CASE("what_is_written_is_read_back") {
  const TemporaryFolder folder;
  std::string content = "line\r\nthen a zero byte, and no newline at the end";
  content.push_back('\0');
  content += std::string(100000, 'x');
  write_file(folder / "new/folders/file.bin", content, false);
  CHECK(read_file(folder / "new/folders/file.bin") == content);
  write_file(folder / "empty", "", false);
  CHECK(read_file(folder / "empty").empty());
}

TEST_CASE("an_existing_file_is_kept_unless_overwriting_is_asked") {
  const TemporaryFolder folder;
  write_file(folder / "file", "mine", false);
  CHECK_THROWS_WITH(write_file(folder / "file", "yours", false),
                    Catch::Contains("exists already") && Catch::Contains("--overwrite"));
  CHECK_THROWS_AS(check_writable(folder / "file", false), Error);
  CHECK(read_file(folder / "file") == "mine");
  CHECK_NOTHROW(check_writable(folder / "file", true));
  write_file(folder / "file", "yours", true);
  CHECK(read_file(folder / "file") == "yours");
  CHECK(folder.files() == 1);
}

TEST_CASE("a_write_that_fails_halfway_leaves_nothing_new_and_the_old_file_whole") {
  const TemporaryFolder folder;
  const bool existed = GENERATE(false, true);
  CAPTURE(existed);
  if (existed) write_file(folder / "file", "old", false);
  {
    const FileSizeLimit full_disc(1000);
    CHECK_THROWS_WITH(write_file(folder / "file", std::string(1000000, 'x'), true),
                      Catch::Contains("cannot write") && Catch::Contains("large"));
  }
  CHECK(folder.files() == (existed ? 1 : 0));
  if (existed) CHECK(read_file(folder / "file") == "old");
}

TEST_CASE("a_content_made_in_blocks_is_written_whole_or_not_at_all") {
  const TemporaryFolder folder;
  write_file(folder / "file", "old", false);
  const auto fails = [](const TextSink& to) {
    to(std::string(1 << 20, 'x'));
    computation_failed("the third part is missing", "", "");
  };
  CHECK_THROWS_WITH(write_file(folder / "file", fails, true), Catch::Contains("third part"));
  CHECK(read_file(folder / "file") == "old");
  CHECK(folder.files() == 1);
  std::string all;
  const auto counts = [&](const TextSink& to) {
    std::string text;
    for (int k = 0; k < 200000; ++k) {
      text += std::to_string(k) + "\n";
      all += std::to_string(k) + "\n";
      pass_block(text, to);
      REQUIRE(text.size() < 1 << 16);
    }
    to(text);
  };
  write_file(folder / "file", counts, true);
  CHECK(read_file(folder / "file") == all);
}

TEST_CASE("a_folder_is_no_file") {
  const TemporaryFolder folder;
  CHECK_THROWS_WITH(read_file(folder.path()), Catch::Contains("it is a folder"));
  CHECK_THROWS_WITH(write_file(folder.path(), "x", true), Catch::Contains("it is a folder"));
  write_file(folder / "file", "x", false);
  CHECK_THROWS_WITH(write_file(folder / "file/inside", "x", false), Catch::Contains("is not a folder"));
}

TEST_CASE("a_link_is_written_through_and_stays_a_link") {
  const TemporaryFolder folder;
  write_file(folder / "file", "old", false);
  fs::create_symlink("file", folder / "link");
  CHECK_THROWS_WITH(write_file(folder / "link", "new", false), Catch::Contains("exists already"));
  write_file(folder / "link", "new", true);
  CHECK(fs::is_symlink(folder / "link"));
  CHECK(read_file(folder / "file") == "new");
  CHECK_THROWS_WITH(check_writable("", true), Catch::Contains("is empty"));
}

TEST_CASE("a_missing_file_is_named") {
  const TemporaryFolder folder;
  CHECK_THROWS_WITH(read_file(folder / "absent.toml"),
                    Catch::Contains("absent.toml") && Catch::Contains("there is no such file"));
}

TEST_CASE("a_place_without_permission_is_refused_before_the_work") {
  // A folder that is closed by its permissions; the superuser may write there, so a folder of the kernel
  // stands in for it.
  const TemporaryFolder folder;
  fs::path closed = folder.path();
  if (geteuid() == 0) {
    closed = "/proc/sys/kernel/nothing";
    CHECK_THROWS_WITH(write_file(closed / "file", "x", false), Catch::Contains("cannot write"));
    return;
  }
  fs::permissions(closed, fs::perms::owner_read | fs::perms::owner_exec);
  CHECK_THROWS_WITH(check_writable(closed / "deep/file", false), Catch::Contains("Permission denied"));
  CHECK_THROWS_WITH(write_file(closed / "file", "x", false), Catch::Contains("Permission denied"));
}

TEST_CASE("a_relative_path_without_a_folder_means_the_current_one") {
  CHECK_NOTHROW(check_writable("equidem-test-file-that-does-not-exist", false));
}

TEST_CASE("a_folder_is_locked_once_and_free_again_when_the_lock_is_gone") {
  const TemporaryFolder folder;
  const auto out = folder.path() / "deep/out";
  std::optional<FolderLock> lock(out);
  CHECK(std::filesystem::is_empty(out));
  CHECK(refusal_of([&] { FolderLock second(out); }).says("/deep/out' is in use (another process of equidem"));
  FolderLock moved = std::move(*lock);
  lock.reset();
  CHECK(refusal_of([&] { FolderLock second(out); }).says("is in use"));
  { const FolderLock taken = std::move(moved); }
  CHECK(refusal_of([&] { FolderLock second(out); }).message.empty());
}

TEST_CASE("folders_that_were_made_and_not_written_to_are_removed_again") {
  const TemporaryFolder folder;
  { const FolderLock lock(folder.path() / "deep" / "out/"); }
  CHECK_FALSE(fs::exists(folder.path() / "deep"));
  {
    const FolderLock lock(folder.path() / "deep" / "out");
    write_file(folder.path() / "deep" / "note.txt", "kept", false);
  }
  CHECK_FALSE(fs::exists(folder.path() / "deep" / "out"));
  CHECK(fs::exists(folder.path() / "deep" / "note.txt"));
  fs::create_directories(folder.path() / "mine");
  { const FolderLock lock(folder.path() / "mine"); }
  CHECK(fs::exists(folder.path() / "mine"));
}

TEST_CASE("the_lock_of_a_killed_process_is_gone") {
  const TemporaryFolder folder;
  int ready[2] = {};
  REQUIRE(pipe(ready) == 0);
  const pid_t child = fork();
  if (child == 0) {
    const FolderLock lock(folder.path());
    static_cast<void>(!write(ready[1], "x", 1));
    pause();
    _exit(0);
  }
  char byte = 0;
  REQUIRE(read(ready[0], &byte, 1) == 1);
  CHECK(refusal_of([&] { FolderLock second(folder.path()); }).says("is in use"));
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  CHECK(refusal_of([&] { FolderLock second(folder.path()); }).message.empty());
  close(ready[0]);
  close(ready[1]);
}

TEST_CASE("files_that_a_killed_process_left_half_written_are_removed_by_the_next_and_no_others") {
  const TemporaryFolder folder;
  const pid_t child = fork();
  if (child == 0) {
    std::ofstream(folder / fmt::format("case.toml.equidem.{}.part", getpid())) << "half";
    pause();
    _exit(0);
  }
  const auto left = folder / fmt::format("case.toml.equidem.{}.part", child);
  while (!fs::exists(left)) usleep(1000);
  const std::vector<fs::path> kept{folder / "case.toml", folder / "film.999999999.part", folder / "a.equidem.1x.part",
                                   folder / "b.equidem..part", folder / fmt::format("c.equidem.{}.part", getpid())};
  for (const fs::path& path : kept) std::ofstream(path) << "x";
  { const FolderLock lock(folder.path()); }
  CHECK(fs::exists(left));  // its process is at work
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  { const FolderLock lock(folder.path()); }
  CHECK_FALSE(fs::exists(left));
  for (const fs::path& path : kept) {
    CAPTURE(path);
    CHECK(fs::exists(path));
  }
}

TEST_CASE("what_is_no_folder_is_not_locked") {
  const TemporaryFolder folder;
  write_file(folder.path() / "file", "", false);
  CHECK(refusal_of([&] { FolderLock lock(folder.path() / "file"); }).says("cannot open the folder"));
}
