// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Wall-clock time per stage of a computation.
#pragma once

#include <chrono>
#include <string>
#include <utility>
#include <vector>

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

}  // namespace equidem
