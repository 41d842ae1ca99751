// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The option --accuracy X of the verbs: the accuracy asked for, the one reached, the cost of ten times more.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "equidem/output/results.hpp"
#include "equidem/study/refinement.hpp"

#include "command.hpp"

namespace equidem {

/// A setting of the verb, by its keys in the case file.
using AccuracySetting = std::vector<std::pair<std::string, double>>;

struct ReachedAccuracy {
  double requested = 0;
  double estimated = 0;
  std::string of;              ///< quantity and source of the errors
  std::string knob = {};       ///< name of the chosen setting; empty: no choice
  AccuracySetting value = {};  ///< value of the chosen setting
  std::string pilots = {};     ///< description of the pilot computations; empty: none
  double pilots_factor = 0;    ///< their work, times that of what was chosen
  /// The settings and the time of a tenth of the error.
  struct TenTimesMore {
    double time_factor = 1;  ///< times the time of what was chosen
    double seconds = 0;      ///< by that
    AccuracySetting value = {};
    std::string note = {};  ///< text in its place if no action is necessary or possible; may be empty
  } ten_times_more = {};
};

/// The note where what was chosen is ten times as accurate as asked.
inline constexpr const char* has_it_already = "nothing: what was chosen has it already";

/// --accuracy X, 0 < X < 1. \param what it does
void add_accuracy_option(CLI::App& command, std::optional<double>& accuracy, const std::string& what);

/// Line of a dry run. \param how the accuracy is reached
Results accuracy_plan(double accuracy, const std::string& how);
inline constexpr const char* bound_is_compared = "the error bound is compared with it, and nothing else is computed";

/// accuracy: {requested, estimated, of, knob, value, pilots, pilots_factor, ten_times_more: {time_factor, seconds,
/// value, note}}.
Results accuracy_results(const ReachedAccuracy& reached);

/// What a search varies, and how its result is reported.
struct SearchedSetting {
  RefinementOptions refinement;
  std::function<AccuracySetting(std::int64_t level)> setting_of;  ///< keys of the case and their values at a level
  std::function<std::vector<double>(Case)> values_of;             ///< solves a case
  std::string of, knob;      ///< as in ReachedAccuracy; the observed order of the errors is added to `of`
  double work_exponent = 1;  ///< work grows as the level to this power
};

/// Search for the coarsest setting of a case that reaches an accuracy:
///
///     do run(search.propose()); while (!search.accepts(values, seconds));
class CaseSearch {
 public:
  CaseSearch(const CommonOptions& options, SearchedSetting searched);
  CaseSearch(const CaseSearch&) = delete;  // the refinement refers to it
  CaseSearch& operator=(const CaseSearch&) = delete;

  /// The case with the setting that should do.
  /// \throws Error (computation_failed) as Refinement::propose
  Case propose();
  /// Whether the values computed with it are known to be within the accuracy.
  bool accepts(std::vector<double> values, double seconds);
  /// All but `pilots`.
  [[nodiscard]] ReachedAccuracy reached() const;
  /// Levels that were computed before the one accepted; the first `pilots` of them without being proposed.
  [[nodiscard]] std::vector<std::int64_t> before() const;
  [[nodiscard]] const std::vector<std::int64_t>& pilots() const { return search_.pilots(); }
  [[nodiscard]] std::int64_t level() const { return proposed_.back(); }
  /// Seconds of the levels before, over those of the last one.
  [[nodiscard]] double seconds_before() const { return seconds_before_ / seconds_; }

 private:
  [[nodiscard]] Case case_of(std::int64_t level) const;

  CommonOptions options_;
  SearchedSetting searched_;
  Refinement search_;
  std::vector<std::int64_t> proposed_;
  double seconds_ = 0, seconds_before_ = 0;  ///< of the last level, and of all before it
};

/// The error that the solver adds to the solution of a given assembly: its error bound.
/// \throws Error (computation_failed) where the bound is above the accuracy, or not known
ReachedAccuracy solver_accuracy(double accuracy, double error_bound, double condition, double seconds);

}  // namespace equidem
