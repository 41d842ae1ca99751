// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/core/progress.hpp"

#include <atomic>
#include <csignal>
#include <cstdio>
#include <utility>

#include <unistd.h>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

std::atomic<bool> progress_shown{true};
volatile std::sig_atomic_t stop_asked = 0;

void ask_to_stop(int signal_number) {
  stop_asked = 1;
  std::signal(signal_number, SIG_DFL);
}

constexpr double first_line_after = 1.0;  // s
constexpr double line_every = 0.2;        // s

}  // namespace

void set_progress_shown(bool shown) {
  progress_shown = shown;
}

Progress::Progress(std::string task) : task_(std::move(task)) {}

Progress::~Progress() {
  if (shown_) std::fputs("\r\033[K", stderr);
}

void Progress::update(double fraction) {
  stop_if_interrupted();
  const double elapsed = watch_.seconds();
  if (elapsed < first_line_after || elapsed - last_shown_ < line_every) return;
  if (!progress_shown || isatty(STDERR_FILENO) == 0) return;
  const double left = fraction > 0 ? elapsed * (1 - fraction) / fraction : 0;
  const std::string line = fmt::format("\r\033[K{} {:.0f} %, {:.0f} s left", task_, 100 * fraction, left);
  std::fputs(line.c_str(), stderr);
  last_shown_ = elapsed;
  shown_ = true;
}

void catch_interrupts() {
  std::signal(SIGINT, ask_to_stop);
  std::signal(SIGTERM, ask_to_stop);
}

void stop_if_interrupted() {
  if (stop_asked != 0) throw Error(ErrorKind::interrupted, "stopped as asked", "", "");
}

}  // namespace equidem
