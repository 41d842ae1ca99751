// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A study for people, as JSON, as a table and as plots.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "equidem/output/files/csv.hpp"
#include "equidem/output/plots/plot.hpp"
#include "equidem/output/results.hpp"
#include "equidem/study/evaluate.hpp"
#include "equidem/study/run_study.hpp"

#include "machine.hpp"

namespace equidem {

/// A study, its result and how it was run.
struct StudyReport {
  const Study& study;
  StudyResult result;
  StudyOptions options;
  Machine machine;
  std::string command;   ///< command that repeats the study
  std::string checksum;  ///< of its settings on this machine and build
  std::optional<double> accuracy;
  std::vector<Recommendation> recommendations;  ///< set if an accuracy is requested
};

/// Report and JSON of the verb.
Results study_results(const StudyReport& report);
/// One row per setting: problem, method, varied values, resolution, times, and of each quantity value, error and
/// assured error.
Table study_table(const StudyReport& report);

/// Name and plot: error against time with its front, for each problem and quantity, and time against the size of the
/// problem; where nothing has an error, time against what is varied.
std::vector<std::pair<std::string, Plot>> study_plots(const StudyReport& report);
/// The names that study_plots will use, known before.
std::vector<std::string> study_plot_names(const Study& study);

}  // namespace equidem
