// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The period of a quantity that oscillates about zero.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

namespace equidem {

/// Counts the passages of a sampled quantity through zero, each interpolated between two samples; the error of the
/// period is of second order in the time between samples.
class Oscillation {
 public:
  /// Add a sample. \param time s, ascending
  void add(double time, double value);

  [[nodiscard]] std::int64_t passages() const { return passages_; }
  /// s, twice the mean time between passages; none before the second passage
  [[nodiscard]] std::optional<double> period() const;
  /// Largest difference of a time between two passages from their mean, over the mean; none before the second passage
  [[nodiscard]] std::optional<double> spread() const;

  static constexpr std::size_t saved = 8;  ///< numbers of a saved state
  [[nodiscard]] std::array<double, saved> save() const;
  static Oscillation restored(std::span<const double, saved> state);

 private:
  std::int64_t samples_ = 0, passages_ = 0;
  double time_ = 0, value_ = 0;        ///< of the last sample
  double first_ = 0, last_ = 0;        ///< s, passages
  double shortest_ = 0, longest_ = 0;  ///< s between two passages
};

}  // namespace equidem
