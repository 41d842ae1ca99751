// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The option --accuracy X of the verbs: the accuracy asked for, the one reached, the cost of ten times more.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "equidem/output/results.hpp"

#include "command.hpp"

namespace equidem {

/// A setting of the verb, by its keys in the case file.
using AccuracySetting = std::vector<std::pair<std::string, double>>;

struct ReachedAccuracy {
  double requested = 0;
  double estimated = 0;
  std::string of;            ///< quantity and source of the errors
  std::string knob;          ///< name of the chosen setting; empty: no choice
  AccuracySetting value;     ///< value of the chosen setting
  std::string pilots;        ///< description of the pilot computations; empty: none
  double pilots_factor = 0;  ///< their work, times that of what was chosen
  /// The settings and the time of a tenth of the error.
  struct TenTimesMore {
    double time_factor = 1;  ///< times the time of what was chosen
    double seconds = 0;      ///< by that
    AccuracySetting value;
    std::string note;  ///< text in its place if no action is necessary or possible; may be empty
  } ten_times_more;
};

/// The note where what was chosen is ten times as accurate as asked.
inline constexpr const char* has_it_already = "nothing: what was chosen has it already";

/// --accuracy X, 0 < X < 1. \param what it does
void add_accuracy_option(CLI::App& command, std::optional<double>& accuracy, const std::string& what);

/// \throws Error (bad_input) where both are given: settings are chosen by computing, and a dry run computes nothing
void refuse_dry_run_with_accuracy(const CommonOptions& options, bool accuracy);

/// accuracy: {requested, estimated, of, knob, value, pilots, pilots_factor, ten_times_more: {time_factor, seconds,
/// value, note}}.
Results accuracy_results(const ReachedAccuracy& reached);

}  // namespace equidem
