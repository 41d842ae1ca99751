// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The coarsest resolution that reaches an accuracy: f(n) = limit + c n^-order, read off a few levels.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace equidem {

struct RefinementOptions {
  double accuracy = 0;          ///< > 0, of the distance below
  double order = 1;             ///< of theory
  std::int64_t first = 1;       ///< the coarsest level, an `admissible` one
  std::int64_t most = 0;        ///< the finest level that may be tried
  std::string unit = "levels";  ///< what levels are numbers of, in messages: "steps"
  /// Levels from which the order is estimated lie at least this apart, > 1: near ones are cheaper, far ones disturbed
  /// less by what is no power of n.
  double apart = 2;
  /// The smallest level >= n that can be computed; empty: every n.
  std::function<std::int64_t(std::int64_t n)> admissible = {};
  /// Distance of b from a, in the measure of `accuracy`; empty: the largest difference of an entry.
  std::function<double(const std::vector<double>& a, const std::vector<double>& b)> distance = {};
};

/// A search for the coarsest level that does:
///
///     Refinement search(pilot, options);
///     do level = search.propose(); while (!search.accepts(level, values_at(level)));
///
/// Pilots are three levels, each `apart` times as fine as the last, and finer ones until the distances between them
/// fall by the order of theory, or within 0.3 of it (relative). What they extrapolate to (Richardson 1911) stands for
/// the limit, with the smaller of both orders; how far the limit moved with the finest of them is added to every error.
class Refinement {
 public:
  using Values = std::vector<double>;

  /// \param pilot computes a level; called by propose() alone
  Refinement(std::function<Values(std::int64_t level)> pilot, RefinementOptions options);

  /// The coarsest level that should reach the accuracy, by all that is known so far.
  /// \throws Error (computation_failed) as soon as it is plain that no level up to `most` does, naming what can be
  ///         reached, or where errors do not fall as theory says up to 64 times the first level; any error that `pilot`
  ///         throws
  std::int64_t propose();
  /// Whether the error of what a level gave, estimated with it, is within the accuracy.
  bool accepts(std::int64_t level, Values values);

  [[nodiscard]] double error(std::int64_t level) const;  ///< of a level that is known, estimated
  [[nodiscard]] double order() const { return order_; }  ///< that was observed, of the distances between levels
  [[nodiscard]] const std::vector<std::int64_t>& pilots() const { return pilots_; }  ///< in the order of trying
  /// Predicted by error ~ level^-theory.
  [[nodiscard]] std::int64_t level_for(double accuracy, std::int64_t level) const;

 private:
  using Level = std::map<std::int64_t, Values>::const_iterator;

  [[noreturn]] void refuse(const std::string& why) const;
  /// \param reached by the finest level that may be tried
  [[noreturn]] void refuse_beyond(double reached) const;
  [[nodiscard]] std::int64_t admissible(double n) const;
  void try_pilot(std::int64_t level);
  /// The finest level, the finest that is well below it, and the finest well below that one.
  [[nodiscard]] std::array<Level, 3> last_three() const;
  /// Order, limit and doubt, from the last three.
  void find_limit();
  /// Judged by the finest level.
  [[nodiscard]] double error_at(double level, double order) const;
  [[nodiscard]] std::int64_t wanted() const;

  std::function<Values(std::int64_t)> pilot_;
  RefinementOptions options_;
  std::map<std::int64_t, Values> values_;
  std::vector<std::int64_t> pilots_;
  double order_ = 0;
  Values limit_;
  double doubt_ = 0;
};

}  // namespace equidem
