// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Repeated measurements of all solvers on one problem, and the tables made of them.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "equidem/output/results.hpp"

#include "measurement.hpp"

namespace equidem::bench {

/// One solver with one number of threads; run r of every solver stems from the same round.
struct Series {
  Trial trial;
  std::vector<Measurement> runs;
};

/// All solvers on one problem.
struct Comparison {
  std::string kind;
  std::int64_t discs = 0;
  std::vector<Series> series;
};

struct ComparisonOptions {
  std::string kind;
  std::int64_t discs = 0;
  std::vector<std::string> solvers;
  std::vector<int> threads;
  int repetitions = 5;
};

/// Rounds in which every solver runs once, so that a disturbance of the machine hits all of them.
/// \param progress is told each trial before it runs
Comparison compare(const ComparisonOptions& options, const std::function<void(int repetition, const Trial&)>& progress);

/// What the tables' columns mean, and how things were measured.
std::string explain_tables();
/// Medians (and the range of totals), and the ratios of equidem to CHOLMOD with its own orderings: medians of
/// the ratios within each round. Two Markdown tables, aligned to be read as they are.
std::string tables(const Comparison& comparison);
Results json(const Comparison& comparison);
/// Processor, number of cores, compiler.
std::string describe_machine();

}  // namespace equidem::bench
