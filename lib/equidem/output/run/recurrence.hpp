// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Events at regular intervals of a run.
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>

namespace equidem {

/// Steps of events at a regular interval in s of the run, each nearest to its time; no events without an interval.
class Recurrence {
 public:
  Recurrence(std::optional<double> interval, double step) : interval_(interval.value_or(0) / step) {}
  /// The first such step after `step`.
  [[nodiscard]] std::int64_t after(std::int64_t step) const {
    if (!(interval_ > 0)) return never;
    if (interval_ <= 1) return step + 1;
    const double turn = std::ceil((static_cast<double>(step) + 0.5) / interval_ - 1e-9);
    double next = std::floor(turn * interval_ + 0.5);
    if (next <= static_cast<double>(step)) next = std::floor((turn + 1) * interval_ + 0.5);
    return next < 1e18 ? static_cast<std::int64_t>(next) : never;
  }
  [[nodiscard]] bool at(std::int64_t step) const { return step == 0 || (step > 0 && after(step - 1) == step); }
  static constexpr std::int64_t never = INT64_MAX;

 private:
  double interval_;
};

}  // namespace equidem
