// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A study: settings to try, the quantity that they measure, its reference value; rounds of timing over all settings.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "equidem/core/names.hpp"

namespace equidem {

/// One way to compute a result.
struct Setting {
  std::string method = {};                                  ///< by what; empty where there is only one
  std::vector<std::pair<std::string, double>> values = {};  ///< what is varied, by name
  /// h > 0, smaller is finer: errors of a method of order p fall as h^p. Not a number: nothing is refined.
  double resolution = std::numeric_limits<double>::quiet_NaN();
  std::optional<double> order = {};  ///< of the method by theory

  /// "rows = 33", "energy_map, time_step = 0.001".
  [[nodiscard]] std::string label() const;
};

/// Reference values of errors.
enum class Truth {
  known,       ///< from a closed form or an independent method: Study::true_value
  finest,      ///< the value at the finest level of the same method, whose own error is not known
  richardson,  ///< the limit of the two finest levels of the same method, by the order of theory
};

template <>
struct EnumNames<Truth> {
  using enum Truth;
  static constexpr const char* what = "kind of truth";
  static constexpr NamedValue<Truth> list[] = {{finest, "finest"}, {richardson, "richardson"}, {known, "known"}};
};

/// A setting made ready to be carried out once.
struct Trial {
  std::function<void()> work;     ///< timed
  std::function<double()> value;  ///< afterwards, not timed
};

/// A setting and how to carry it out. The work is the same each time, to the last bit.
struct StudyTask {
  Setting setting;
  std::function<Trial()> prepare;  ///< not timed
};

struct Study {
  std::string name;
  std::string title;
  std::string quantity;     ///< that is measured: "poisson_ratio"
  std::string label = {};   ///< of its axis: "error of Poisson's ratio"
  std::string source = {};  ///< of the truth: "closed form, Abe (1996), eq. (22)"
  bool relative = false;    ///< errors are divided by the truth
  Truth truth = Truth::known;
  double true_value = 0;  ///< Truth::known
  std::vector<StudyTask> tasks = {};
  std::vector<std::string> notes = {};  ///< sentences: what is computed, and what to make of it

  /// Checksum of name, quantity, truth and settings, as 16 hexadecimal digits: measurements of studies with one sum fit
  /// together. \param context what else they depend on, such as machine and build
  [[nodiscard]] std::string checksum(const std::string& context) const;
};

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
  std::optional<double> value = {};  ///< empty: not yet tried, or refused
  std::string refusal = {};          ///< why the setting has no value
  std::vector<TimeSample> times = {};

  [[nodiscard]] bool tried() const { return value.has_value() || !refusal.empty(); }
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
