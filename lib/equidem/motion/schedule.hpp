// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Values that change with time: prescribed motions, factors of loads.
#pragma once

#include <vector>

namespace equidem {

/// A value as a function of time.
struct Schedule {
  enum class Kind {
    constant,  ///< value
    ramp,      ///< from 0 at `start` to value at `end`, smooth (cosine: no jump in velocity), value afterwards
    sine,      ///< value sin(2 pi frequency (t - start)), 0 before start
    table,     ///< linear between points, constant outside
    /// value (1 - cos(2 pi frequency (t - start))) from start to end, whole cycles later; 0 outside. From rest to rest,
    /// and the acceleration is value (2 pi frequency)² cos(...) all along: full from the first instant to the last.
    cycles,
    smooth_table,  ///< cubic between points, with the rates there; constant outside
  } kind = Kind::constant;
  double value = 0;
  double start = 0;                             ///< s
  double end = 0;                               ///< s, ramp, cycles: > start
  double frequency = 0;                         ///< Hz, sine, cycles: > 0
  std::vector<double> times = {}, values = {};  ///< tables: times ascending, at least one
  std::vector<double> rates = {};               ///< smooth_table: derivatives of the values, 1/s

  /// The same bits on every machine.
  [[nodiscard]] double at(double time) const;
  [[nodiscard]] bool changes() const { return kind != Kind::constant; }
  bool operator==(const Schedule&) const = default;
};

/// \throws Error (bad_input) on numbers that are not finite, an end before the start, a frequency that is not positive,
///         cycles that are not whole, times that do not ascend
void check(const Schedule& schedule);

/// What of a schedule lies between the moments at which it is looked at.
struct MissedEvent {
  double share = 0;  ///< of the range of its values, in [0, 1]
  double time = 0;   ///< s
};

/// The most that steps of a given length miss of a schedule within a run, its values at two successive steps taken to
/// span all between them: a point of a table that stands out; the peaks of a sine or of cycles, all of them below two
/// steps a period. A jump is not missed. \param step, end s
MissedEvent missed_event(const Schedule& schedule, double step, double end);

/// The schedule times a factor, at every time.
Schedule scaled(Schedule schedule, double factor);

}  // namespace equidem
