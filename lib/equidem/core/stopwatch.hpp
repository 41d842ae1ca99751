// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Wall-clock time per stage of a computation.
/// Progress on stderr, and interruption by the user.
#pragma once

#include <chrono>
#include <csignal>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "equidem/core/error.hpp"

namespace equidem {

/// Seconds of wall-clock time spent in each stage, in the order in which the stages first ran.
class StageTimes {
 public:
  /// Add seconds to a stage, which is created where it is new.
  void add(const std::string& stage, double seconds);
  void add(const StageTimes& others);
  /// Seconds of a stage; 0 where it never ran.
  [[nodiscard]] double of(const std::string& stage) const;
  [[nodiscard]] double total() const;
  [[nodiscard]] const std::vector<std::pair<std::string, double>>& stages() const { return stages_; }

 private:
  std::vector<std::pair<std::string, double>> stages_;
};

/// Seconds since construction or the last lap.
class Stopwatch {
 public:
  [[nodiscard]] double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }
  /// Seconds since the last lap; starts the next one.
  double lap() {
    const double elapsed = seconds();
    start_ = std::chrono::steady_clock::now();
    return elapsed;
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// Whether progress may be shown; on by default.
void set_progress_shown(bool shown);

/// Progress of a long computation on stderr: "factorizing 42 %, 7 s left". On a terminal one line, from the second
/// second on; elsewhere a line after three seconds, then one a minute. While one exists, others show nothing.
class Progress {
 public:
  explicit Progress(std::string task);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// \param fraction of the work done, in [0, 1]
  /// \throws Error of kind interrupted where the user asked to stop
  void update(double fraction);

 private:
  std::string task_;
  Stopwatch watch_;
  double last_shown_ = 0;
  bool outermost_, terminal_;
  bool shown_ = false;
};

/// From now on SIGINT (Ctrl-C), SIGTERM and SIGHUP (not under nohup) ask the running computation to stop at its next
/// safe point, which stderr says at once; a second SIGINT or SIGTERM, later than half a second (timeout of coreutils
/// sends two), ends the process at once. SIGXFSZ is ignored.
void catch_interrupts();
/// \throws Error of kind interrupted where the user asked to stop
void stop_if_interrupted();

/// While one exists, stop_if_interrupted returns in this thread, and in the loops that it shares out: what was done
/// before the user asked to stop is evaluated and written to its end.
class StopsHeldBack {
 public:
  explicit StopsHeldBack(bool held = true);
  /// Where the failure is that the user asked to stop.
  explicit StopsHeldBack(const std::optional<Error>& failure);
  ~StopsHeldBack();
  StopsHeldBack(const StopsHeldBack&) = delete;
  StopsHeldBack& operator=(const StopsHeldBack&) = delete;

  /// Whether one exists for this thread.
  [[nodiscard]] static bool any();

 private:
  bool held_;
};

/// For programs that handle SIGINT themselves: while one exists, Ctrl-C asks the running computation to stop;
/// afterwards their handler is back, and nothing is asked any more. At most one exists.
class InterruptCatcher {
 public:
  InterruptCatcher();
  ~InterruptCatcher();
  InterruptCatcher(const InterruptCatcher&) = delete;
  InterruptCatcher& operator=(const InterruptCatcher&) = delete;

 private:
  struct sigaction before_ = {};
};

/// A function that shows a line of progress in place of stderr, on which an empty line clears it; none: stderr.
void set_progress_display(std::function<void(const std::string& line)> shown_by);

}  // namespace equidem
