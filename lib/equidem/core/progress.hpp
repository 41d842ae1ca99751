// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Progress on stderr, and interruption by the user.
#pragma once

#include <string>

#include "equidem/core/stopwatch.hpp"

namespace equidem {

/// Whether progress may be shown at all; on by default, and even then only where stderr is a terminal.
void set_progress_shown(bool shown);

/// A line on stderr with the progress of a long computation: "factorizing 42 %, 7 s left". Shown from the second
/// second on, so that short computations stay silent.
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
  bool shown_ = false;
};

/// From now on Ctrl-C (SIGINT) and SIGTERM ask the running computation to stop at its next safe point; a second one
/// ends the process at once.
void catch_interrupts();
/// \throws Error of kind interrupted where the user asked to stop
void stop_if_interrupted();

}  // namespace equidem
