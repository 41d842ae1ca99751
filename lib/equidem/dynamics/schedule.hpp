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
  } kind = Kind::constant;
  double value = 0;
  double start = 0;                             ///< s
  double end = 0;                               ///< s, ramp: > start
  double frequency = 0;                         ///< Hz, sine: > 0
  std::vector<double> times = {}, values = {};  ///< table: times ascending, at least one

  /// The same bits on every machine.
  [[nodiscard]] double at(double time) const;
  [[nodiscard]] bool changes() const { return kind != Kind::constant; }
  bool operator==(const Schedule&) const = default;
};

/// \throws Error (bad_input) on numbers that are not finite, an end before the start, a frequency that is not positive,
///         times that do not ascend
void check(const Schedule& schedule);

/// The schedule times a factor, at every time.
Schedule scaled(Schedule schedule, double factor);

}  // namespace equidem
