// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Evaluation of the measurements of a study: errors, orders, fronts, advice.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "equidem/study/order.hpp"
#include "equidem/study/run_study.hpp"
#include "equidem/study/study.hpp"

namespace equidem {

/// A setting, measured.
struct StudyRow {
  Setting setting;
  Timing time;
  std::vector<double> values;  ///< one per quantity; empty where refused
  std::vector<double> errors;  ///< likewise; not a number: a fact, or no part of this problem, or itself the truth
  /// The largest error of this and all finer settings of the same problem and method: an error that is small only
  /// because it changes its sign between two levels does not count.
  std::vector<double> assured;
  std::string refusal;
};

/// A method refined: rows of one problem and method with a resolution, from coarse to fine, seen by one quantity.
struct StudyCurve {
  std::string problem, method;
  std::size_t quantity = 0;
  std::vector<std::size_t> rows;
  std::optional<ObservedOrder> order = {};
  std::optional<ExpectedOrder> expected = {};
  double cost_exponent = 0;  ///< time ~ h^-cost over the finer half of the levels
  bool agrees = false;  ///< observed and expected order lie within 0.1, or within the uncertainty of the one observed
};

/// The settings of one problem that nothing beats in one quantity.
struct StudyFront {
  std::string problem;
  std::size_t quantity = 0;
  std::vector<std::size_t> rows;  ///< in the order of time
};

struct StudyResult {
  std::vector<StudyRow> rows;
  std::vector<StudyCurve> curves;
  std::vector<StudyFront> fronts;
  std::vector<std::string> advice;  ///< sentences, one for each problem
  int rounds = 0;
  bool complete = true;
};

StudyResult evaluate(const Study& study, const StudySamples& samples);

/// The cheapest setting of each problem all of whose assured errors are at most `accuracy`.
struct Recommendation {
  std::string problem;
  std::optional<std::size_t> row;
  double best = 0;   ///< the smallest error that any setting assures
  std::string text;  ///< a sentence: the setting, its error and time, and what ten times more accuracy would cost
};
std::vector<Recommendation> recommend(const Study& study, const StudyResult& result, double accuracy);

/// The problems of a study, in the order in which they first occur.
std::vector<std::string> problems_of(const Study& study);

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
