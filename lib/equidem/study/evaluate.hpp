// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Evaluation of the measurements of a study: errors, orders of convergence, the front, advice.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "equidem/study/study.hpp"

namespace equidem {

/// One level of a series of refinements.
struct Level {
  double h = 0;  ///< resolution, > 0: 1/rows, the time step, a tolerance; smaller is finer
  double error = 0;
};

/// error = constant h^order over the finest levels.
struct ObservedOrder {
  double order = 0;
  double uncertainty = 0;  ///< half width of the 95 % interval; NaN of two levels
  double constant = 0;
  double coarsest = 0, finest = 0;  ///< h, the range that was fitted
  std::size_t levels = 0;

  [[nodiscard]] double error_at(double h) const;
};

/// Slope of log error over log h, least squares over the asymptotic range: at least four levels from the finest on
/// (where there are so many), and as many coarser ones as leave the slope known within twice the narrowest of these
/// intervals (Student's). Where errors do not scatter but bend, and the orders between neighbours settle, the last of
/// these, uncertain by its last change. Errors at or below `floor`, where rounding takes over, are left out, and so is
/// what is not finite; the same level twice counts once. Empty below two levels.
std::optional<ObservedOrder> observed_order(std::span<const Level> levels, double floor = 0);

/// The limit h -> 0 of f(h) = limit + c h^order from two levels (Richardson 1911).
double richardson_limit(double coarse_h, double coarse, double fine_h, double fine, double order);

/// The order p for which three levels lie on f = limit + c h^p: (f1 - f2)/(f2 - f3) = (h1^p - h2^p)/(h2^p - h3^p), by
/// bisection in [0.05, 20]. Empty where the values do not approach a limit that way. \param h descending
std::optional<double> order_of_three(std::span<const double, 3> h, std::span<const double, 3> values);

/// The factor by which time grows where errors fall by `factor`, for time ~ h^-cost and error ~ h^order:
/// factor^(cost/order).
double cost_of_accuracy(double factor, double cost_exponent, double order);

/// A setting, measured.
struct StudyRow {
  Setting setting;
  Timing time;
  std::optional<double> value;  ///< empty where refused
  double error = 0;             ///< not a number: refused, or itself the truth
  /// The largest error of this and all finer settings of the same method: an error that is small only because it
  /// changes its sign between two levels does not count.
  double assured = 0;
  std::string refusal;
};

/// A method refined: its rows with a resolution, from coarse to fine.
struct StudyCurve {
  std::string method;
  std::vector<std::size_t> rows;
  std::optional<ObservedOrder> order = {};
  std::optional<double> expected = {};  ///< order of theory
  double cost_exponent = 0;             ///< time ~ h^-cost over the finer half of the levels
  bool agrees = false;  ///< observed and expected order lie within 0.1, or within the uncertainty of the one observed
};

struct StudyResult {
  std::vector<StudyRow> rows;
  std::vector<StudyCurve> curves;
  std::vector<std::size_t> front;  ///< rows that nothing beats, in the order of time
  std::string advice;              ///< sentences; empty without a front
  int rounds = 0;
  bool complete = true;
};

StudyResult evaluate(const Study& study, const StudySamples& samples);

/// The cheapest setting whose assured error is at most an accuracy.
struct Recommendation {
  std::optional<std::size_t> row;
  double best = 0;   ///< the smallest error that any setting assures
  std::string text;  ///< a sentence: the setting, its error and time, and what ten times more accuracy would cost
};
/// Empty where no setting has an error.
std::optional<Recommendation> recommend(const StudyResult& result, double accuracy);

/// "1.2 ms", "34 s".
std::string readable_seconds(double seconds);

/// Cost and error of a setting.
struct CostPoint {
  double seconds = 0;
  double error = 0;  ///< not a number: it takes no part
};

/// The Pareto front: the points than which none is both faster and at least as accurate, in the order of time. Errors
/// fall along it.
std::vector<std::size_t> front_of(std::span<const CostPoint> points);

/// The fastest point with at most that error; empty where there is none.
std::optional<std::size_t> cheapest_within(std::span<const CostPoint> points, double error);

}  // namespace equidem
