// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/output/plots/gnuplot.hpp"

#include <cerrno>
#include <cstring>

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "equidem/core/text.hpp"

namespace equidem {
namespace {

// Exit statuses of the program `timeout`.
constexpr int timed_out = 124, not_installed = 127;

/// gnuplot echoes the line with a caret under the fault and prints "line 7: reason" last.
std::string last_line(std::string text) {
  while (!text.empty() && (text.back() == '\n' || text.back() == '\r')) text.pop_back();
  return text.substr(text.rfind('\n') + 1);
}

}  // namespace

GnuplotRun run_gnuplot(const std::filesystem::path& folder, const std::string& script, double time_limit) {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0)
    return {false, fmt::format("gnuplot could not be started: {}", std::strerror(errno))};
  const std::string working_folder = folder.empty() ? "." : folder.string(), limit = fmt::format("{}", time_limit);
  const char* arguments[] = {"timeout", limit.c_str(), "gnuplot", script.c_str(), nullptr};
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addchdir_np(&actions, working_folder.c_str());
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, ends[1], STDERR_FILENO);
  pid_t child = 0;
  const int failure =
      posix_spawnp(&child, arguments[0], &actions, nullptr, const_cast<char* const*>(arguments), environ);
  posix_spawn_file_actions_destroy(&actions);
  close(ends[1]);
  std::string complaint;
  char buffer[1024];
  for (ssize_t count = 0; (count = read(ends[0], buffer, sizeof buffer)) != 0;) {
    if (count > 0) complaint.append(buffer, static_cast<std::size_t>(count));
    if (count < 0 && errno != EINTR) break;
  }
  close(ends[0]);
  if (failure == ENOENT) return {false, "gnuplot is not installed"};
  if (failure != 0) return {false, fmt::format("gnuplot could not be started: {}", std::strerror(failure))};
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  const int code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  if (code == 0) return {true, {}};
  if (code == timed_out) return {false, fmt::format("gnuplot took more than {} s", time_limit)};
  if (code == not_installed) return {false, "gnuplot is not installed"};
  const std::string line = last_line(complaint);
  return {false, line.empty() ? "gnuplot failed without a message" : "gnuplot reports: " + line};
}

}  // namespace equidem
