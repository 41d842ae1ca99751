// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The coarsest resolution that reaches an accuracy: f(n) = limit + c n^-order, read off a few levels.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

namespace equidem {

struct RefinementOptions {
  double accuracy = 0;     ///< > 0, of the distance below
  double order = 1;        ///< of theory
  std::int64_t first = 1;  ///< the coarsest level, an `admissible` one
  std::int64_t most = 0;   ///< the finest level that may be tried
  /// The smallest level >= n that can be computed; empty: every n.
  std::function<std::int64_t(std::int64_t n)> admissible = {};
  /// How far b is from a, in the measure of `accuracy`; empty: the largest difference of an entry.
  std::function<double(const std::vector<double>& a, const std::vector<double>& b)> distance = {};
};

struct Refinement {
  std::int64_t level = 0;
  std::vector<double> values;        ///< there
  double estimated = 0;              ///< distance from the limit, with what the limit itself is unsure by
  double order = 0;                  ///< that was observed
  double theory = 0;                 ///< the order of theory
  std::vector<std::int64_t> levels;  ///< all that were computed, in the order of trying
  [[nodiscard]] std::int64_t level_for(double accuracy) const;  ///< by estimated ~ level^-theory
};

/// Compute three levels, each twice as fine as the last, and finer ones until the errors fall by the order of theory (within 0.3);
/// extrapolate (Richardson 1911); go to the coarsest level that should reach the accuracy, and on from there until its own estimate does.
/// \throws Error (computation_failed) where that takes a level finer than `most`, or errors do not fall as theory says up to there, naming
///         the accuracy that can be reached; whatever `evaluate` throws
Refinement refine_to(const std::function<std::vector<double>(std::int64_t level)>& evaluate,
                     const RefinementOptions& options);

}  // namespace equidem
