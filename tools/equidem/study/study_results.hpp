// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Report, JSON, table and plot of a study.
#pragma once

#include <optional>
#include <string>

#include "equidem/output/files/csv.hpp"
#include "equidem/output/plots/plot.hpp"
#include "equidem/output/results.hpp"
#include "equidem/study/evaluate.hpp"

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
  std::optional<Recommendation> recommendation;  ///< set if an accuracy is requested
};

/// Report and JSON of the verb.
Results study_results(const StudyReport& report);
/// One row per setting: method, varied values, resolution, times, value, error and assured error.
Table study_table(const StudyReport& report);

/// Error against time with the front.
Plot study_plot(const StudyReport& report);
/// Its name.
std::string study_plot_name(const Study& study);

}  // namespace equidem
