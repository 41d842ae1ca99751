// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/core/stopwatch.hpp"

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <ctime>
#include <string_view>
#include <utility>

#include <unistd.h>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

namespace equidem {

void StageTimes::add(const std::string& stage, double seconds) {
  const auto known = std::find_if(stages_.begin(), stages_.end(), [&](const auto& s) { return s.first == stage; });
  if (known == stages_.end()) {
    stages_.emplace_back(stage, seconds);
  } else {
    known->second += seconds;
  }
}

void StageTimes::add(const StageTimes& others) {
  for (const auto& [stage, seconds] : others.stages_) add(stage, seconds);
}

double StageTimes::of(const std::string& stage) const {
  for (const auto& [name, seconds] : stages_) {
    if (name == stage) return seconds;
  }
  return 0;
}

double StageTimes::total() const {
  double sum = 0;
  for (const auto& [name, seconds] : stages_) sum += seconds;
  return sum;
}

namespace {

std::atomic<bool> progress_shown{true};
std::atomic<int> existing{0};
/// Set by a handler on any thread, and read by all.
std::atomic<bool> stop_asked{false};
static_assert(std::atomic<bool>::is_always_lock_free, "signal handlers may touch no other");
timespec asked_at = {};

double seconds_since(const timespec& then) {
  timespec now = {};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return static_cast<double>(now.tv_sec - then.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec - then.tv_nsec);
}

/// Calls what is safe in a signal handler alone.
void ask_to_stop(int signal_number) {
  constexpr std::string_view answer = "stopping: what is done is written first; a second signal ends this at once\n";
  constexpr double one_request = 0.5;  // s
  const int error = errno;
  if (!stop_asked) {
    [[maybe_unused]] const ssize_t written = write(STDERR_FILENO, answer.data(), answer.size());
    clock_gettime(CLOCK_MONOTONIC, &asked_at);
    stop_asked = true;
  } else if (signal_number != SIGHUP && seconds_since(asked_at) > one_request) {
    // of a terminal that closes, SIGHUP comes from the system and from its shell
    std::signal(signal_number, SIG_DFL);
    std::raise(signal_number);
  }
  errno = error;
}

/// s
struct Rhythm {
  double first_line_after, line_every;
};
constexpr Rhythm on_terminal{1, 0.2}, elsewhere{3, 60};

std::function<void(const std::string&)> display;

}  // namespace

void set_progress_shown(bool shown) {
  progress_shown = shown;
}

Progress::Progress(std::string task)
    : task_(std::move(task)), outermost_(existing++ == 0), terminal_(display || isatty(STDERR_FILENO) != 0) {}

Progress::~Progress() {
  --existing;
  if (!shown_ || !terminal_) return;
  if (display) {
    display("");
  } else {
    std::fputs("\r\033[K", stderr);
  }
}

void Progress::update(double fraction) {
  stop_if_interrupted();
  if (!progress_shown || !outermost_) return;
  const double elapsed = watch_.seconds();
  const Rhythm& rhythm = terminal_ ? on_terminal : elsewhere;
  if (elapsed < rhythm.first_line_after || (shown_ && elapsed - last_shown_ < rhythm.line_every)) return;
  std::string line = fmt::format("{} {:.0f} %", task_, 100 * fraction);
  if (fraction > 0) line += fmt::format(", {:.0f} s left", elapsed * (1 - fraction) / fraction);
  if (display) {
    display(line);
  } else {
    std::fputs((terminal_ ? "\r\033[K" + line : line + "\n").c_str(), stderr);
  }
  last_shown_ = elapsed;
  shown_ = true;
}

void catch_interrupts() {
  std::signal(SIGINT, ask_to_stop);
  std::signal(SIGTERM, ask_to_stop);
  if (std::signal(SIGHUP, ask_to_stop) == SIG_IGN) std::signal(SIGHUP, SIG_IGN);  // by nohup
  std::signal(SIGXFSZ, SIG_IGN);                                                  // writes fail instead
}

InterruptCatcher::InterruptCatcher() {
  struct sigaction caught = {};
  caught.sa_handler = [](int) { stop_asked = true; };
  sigaction(SIGINT, &caught, &before_);
}

InterruptCatcher::~InterruptCatcher() {
  sigaction(SIGINT, &before_, nullptr);
  stop_asked = false;
}

void set_progress_display(std::function<void(const std::string&)> shown_by) {
  display = std::move(shown_by);
}

void stop_if_interrupted() {
  if (stop_asked && !StopsHeldBack::any()) throw Error(ErrorKind::interrupted, "stopped as asked", "", "");
}

namespace {

thread_local int holds_of_stops = 0;

}  // namespace

StopsHeldBack::StopsHeldBack(bool held) : held_(held) {
  holds_of_stops += held_ ? 1 : 0;
}

StopsHeldBack::StopsHeldBack(const std::optional<Error>& failure)
    : StopsHeldBack(failure && failure->kind() == ErrorKind::interrupted) {}

StopsHeldBack::~StopsHeldBack() {
  holds_of_stops -= held_ ? 1 : 0;
}

bool StopsHeldBack::any() {
  return holds_of_stops > 0;
}

}  // namespace equidem
