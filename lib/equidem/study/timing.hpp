// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// How long something takes, and how well that is known.
#pragma once

#include <functional>
#include <span>

namespace equidem {

/// One timing of a piece of work.
struct TimeSample {
  double seconds = 0;            ///< by the clock on the wall
  double processor_seconds = 0;  ///< of the thread that did it
};

/// Many timings of the same work. The median, since what disturbs a machine only ever makes it slower, now and then by
/// much.
struct Timing {
  double median = 0;                              ///< s
  double lower_quartile = 0, upper_quartile = 0;  ///< s
  double processor_median = 0;                    ///< s
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

/// Time work once; what is too short for the clock is done again, each time on fresh ground, until `least` seconds of
/// it are seen, and the mean is taken. \param prepare makes the work ready to be done once; not timed
TimeSample time_work(const std::function<std::function<void()>()>& prepare, double least = 1e-3);

}  // namespace equidem
