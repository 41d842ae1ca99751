// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Carrying out a study: rounds over all settings.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "equidem/study/study.hpp"

namespace equidem {

/// One timing of a piece of work.
struct TimeSample {
  double seconds = 0;            ///< wall-clock time
  double processor_seconds = 0;  ///< of the thread that did it
};

/// Many timings of the same work. The median, because disturbances of a machine only slow it down, occasionally by
/// much.
struct Timing {
  double median = 0;                                                  ///< s
  double lower_quartile = 0, upper_quartile = 0;                      ///< s
  double processor_median = 0;                                        ///< s
  double processor_lower_quartile = 0, processor_upper_quartile = 0;  ///< s
  int repetitions = 0;

  /// Relative standard error of the median: 1.2533 sd/sqrt(n), sd from the quartiles, which lie 1.349 sd apart (normal
  /// distribution). Infinite below three repetitions.
  [[nodiscard]] double relative_error() const;
};

Timing summarize(std::span<const TimeSample> samples);

/// Linear between the order statistics. \param sorted ascending, not empty \param share in [0, 1]
double quantile(std::span<const double> sorted, double share);

/// Processor time of the calling thread, s.
double thread_seconds();

/// Time work once; work too short for the clock is repeated, each time newly prepared, until it has taken `least`
/// seconds, and the mean is taken. \param prepare makes the work ready to be done once; not timed
TimeSample time_work(const std::function<std::function<void()>()>& prepare, double least = 1e-3);

struct StudyOptions {
  double budget = 60;        ///< s, after which no round begins once `least_rounds` are there
  int least_rounds = 5;      ///< >= 3
  int most_rounds = 100;     ///< >= least_rounds
  double time_error = 0.02;  ///< relative error of all medians at which times are trusted
  std::uint64_t seed = 1;    ///< of the order of settings
};

/// Measurements of one setting.
struct TaskSamples {
  std::vector<double> values;  ///< one per quantity; empty: not yet tried
  std::string refusal;         ///< why the setting has no values; empty: it has
  std::vector<TimeSample> times;

  [[nodiscard]] bool tried() const { return !values.empty() || !refusal.empty(); }
};

struct StudySamples {
  std::vector<TaskSamples> tasks;    ///< one per task
  bool stopped = false;              ///< by the user, before the end
  [[nodiscard]] int rounds() const;  ///< that all settings have been through
};

/// Every round goes once through all settings, in an order drawn anew, so that a machine that gets slower or busier
/// hurts all alike. The first round warms up: it gives the values, its times are not kept. Rounds go on until all times
/// are trusted or the budget is spent. A setting that fails is kept with its reason; an interruption ends the
/// study and keeps what is done. Shows progress.
/// \param kept results of an earlier run of the study, which is continued; empty: none
/// \param save called after each setting with all samples so far; may be empty
StudySamples run_study(const Study& study, const StudyOptions& options, StudySamples kept = {},
                       const std::function<void(const StudySamples& done)>& save = {});

}  // namespace equidem
