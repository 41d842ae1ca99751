// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/output/plots/gnuplot.hpp"

#include <cerrno>
#include <csignal>
#include <cstring>

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "equidem/core/error.hpp"
#include "equidem/core/progress.hpp"
#include "equidem/core/stopwatch.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

/// gnuplot echoes the line with a caret under the fault and prints "line 7: reason" last.
std::string last_line(std::string text) {
  while (!text.empty() && (text.back() == '\n' || text.back() == '\r')) text.pop_back();
  return text.substr(text.rfind('\n') + 1);
}

/// A child process in a process group of its own, which ends with this object, and all that it has started with it.
class Gnuplot {
 public:
  Gnuplot(const std::string& folder, const std::string& script) {
    int ends[2];
    if (pipe2(ends, O_CLOEXEC | O_NONBLOCK) != 0) {
      failure_ = errno;
      return;
    }
    const char* arguments[] = {"gnuplot", script.c_str(), nullptr};
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addchdir_np(&actions, folder.c_str());
    posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    posix_spawn_file_actions_adddup2(&actions, ends[1], STDERR_FILENO);
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    sigset_t usual;
    sigemptyset(&usual);
    for (const int signal : {SIGPIPE, SIGXFSZ, SIGINT, SIGTERM, SIGHUP}) sigaddset(&usual, signal);
    posix_spawnattr_setsigdefault(&attributes, &usual);
    posix_spawnattr_setpgroup(&attributes, 0);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGDEF);
    failure_ = posix_spawnp(&child_, arguments[0], &actions, &attributes, const_cast<char* const*>(arguments), environ);
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&actions);
    close(ends[1]);
    complaints_ = ends[0];
    if (failure_ != 0) child_ = 0;
  }
  ~Gnuplot() {
    if (child_ != 0) {
      kill(-child_, SIGKILL);
      waitpid(child_, nullptr, 0);
    }
    if (complaints_ >= 0) close(complaints_);
  }
  Gnuplot(const Gnuplot&) = delete;
  Gnuplot& operator=(const Gnuplot&) = delete;

  [[nodiscard]] int failure() const { return failure_; }  ///< errno where it was not started

  /// Waits for its end for some ms. \return whether it has ended
  bool ended(int wait) {
    pollfd complaint{complaints_, POLLIN, 0};
    poll(&complaint, 1, wait);
    char buffer[1024];
    for (ssize_t count = 0; (count = read(complaints_, buffer, sizeof buffer)) > 0;)
      text_.append(buffer, static_cast<std::size_t>(count));
    if (waitpid(child_, &status_, WNOHANG) == 0) {
      if ((complaint.revents & (POLLHUP | POLLIN)) == POLLHUP) poll(nullptr, 0, wait);  // it closed its stderr
      return false;
    }
    kill(-child_, SIGKILL);  // what it has left running
    child_ = 0;
    return true;
  }
  [[nodiscard]] bool succeeded() const { return WIFEXITED(status_) && WEXITSTATUS(status_) == 0; }
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  pid_t child_ = 0;
  int complaints_ = -1, status_ = 0, failure_ = 0;
  std::string text_;
};

bool stop_is_asked() {
  try {
    stop_if_interrupted();
  } catch (const Error&) {
    return true;
  }
  return false;
}

}  // namespace

GnuplotRun run_gnuplot(const std::filesystem::path& folder, const std::string& script, double time_limit) {
  Gnuplot gnuplot(folder.empty() ? "." : folder.string(), script);
  if (gnuplot.failure() == ENOENT) return {false, "gnuplot is not installed"};
  if (gnuplot.failure() != 0)
    return {false, fmt::format("gnuplot could not be started: {}", std::strerror(gnuplot.failure()))};
  constexpr int poll_every = 20;                // ms
  const bool stopped_before = stop_is_asked();  // the figures of what is done are drawn all the same
  for (const Stopwatch watch; !gnuplot.ended(poll_every);) {
    if (!stopped_before) stop_if_interrupted();
    if (watch.seconds() > time_limit) return {false, fmt::format("gnuplot took more than {} s", time_limit), true};
  }
  if (gnuplot.succeeded()) return {true, {}};
  const std::string line = last_line(gnuplot.text());
  return {false, line.empty() ? "gnuplot failed without a message" : "gnuplot reports: " + line};
}

}  // namespace equidem
