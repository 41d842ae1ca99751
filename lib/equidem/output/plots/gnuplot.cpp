// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/output/plots/gnuplot.hpp"

#include <cerrno>
#include <csignal>
#include <cstring>

#include <fcntl.h>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include "equidem/core/stopwatch.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

constexpr int not_installed = 127;  // exit status of a child whose exec failed, as a shell would give it
constexpr std::size_t longest_complaint = 4096;

/// In the child: only calls that are safe between fork and exec.
[[noreturn]] void become_gnuplot(const char* folder, const char* script, int complaints) {
  const int nothing = open("/dev/null", O_RDWR);
  dup2(nothing, STDIN_FILENO);
  dup2(nothing, STDOUT_FILENO);
  dup2(complaints, STDERR_FILENO);
  if (chdir(folder) != 0) _exit(not_installed - 1);
  const char* arguments[] = {"gnuplot", script, nullptr};
  execvp("gnuplot", const_cast<char* const*>(arguments));
  _exit(not_installed);
}

/// Reads the output of the child until it closes the pipe; false if it exceeds the time limit.
bool read_until_closed(int pipe_end, double time_limit, std::string& text) {
  const Stopwatch watch;
  char buffer[1024];
  while (true) {
    const double left = time_limit - watch.seconds();
    if (left <= 0) return false;
    pollfd waiting{pipe_end, POLLIN, 0};
    if (poll(&waiting, 1, static_cast<int>(1000 * left) + 1) <= 0) continue;
    const ssize_t count = read(pipe_end, buffer, sizeof buffer);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return true;
    if (text.size() < longest_complaint) text.append(buffer, static_cast<std::size_t>(count));
  }
}

/// gnuplot echoes the line with a caret under the fault and prints "line 7: what" last.
std::string last_line(std::string text) {
  while (!text.empty() && (text.back() == '\n' || text.back() == '\r')) text.pop_back();
  const std::size_t start = text.rfind('\n');
  return start == std::string::npos ? text : text.substr(start + 1);
}

}  // namespace

GnuplotRun run_gnuplot(const std::filesystem::path& folder, const std::string& script, double time_limit) {
  const std::string working_folder = folder.empty() ? "." : folder.string();
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) {
    return {false, fmt::format("gnuplot could not be started: {}", std::strerror(errno))};
  }
  const pid_t child = fork();
  if (child == 0) become_gnuplot(working_folder.c_str(), script.c_str(), ends[1]);
  close(ends[1]);
  if (child < 0) {
    close(ends[0]);
    return {false, fmt::format("gnuplot could not be started: {}", std::strerror(errno))};
  }

  std::string complaint;
  const bool in_time = read_until_closed(ends[0], time_limit, complaint);
  close(ends[0]);
  if (!in_time) kill(child, SIGKILL);
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (!in_time) return {false, fmt::format("gnuplot took more than {} s", time_limit)};
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return {true, {}};
  if (WIFEXITED(status) && WEXITSTATUS(status) == not_installed && complaint.empty()) {
    return {false, "gnuplot is not installed"};
  }
  const std::string line = last_line(complaint);
  return {false, line.empty() ? "gnuplot failed without a word" : "gnuplot says: " + line};
}

}  // namespace equidem
