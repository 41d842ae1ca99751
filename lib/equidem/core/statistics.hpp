// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Means of samples, lines through them, and how well both are known.
#pragma once

#include <cstdint>
#include <limits>
#include <span>

namespace equidem {

/// The number t for which |T| <= t with the probability `confidence`, T distributed as Student's t.
/// \param confidence in (0, 1)
/// \param degrees_of_freedom >= 1
double student_critical_value(double confidence, std::int64_t degrees_of_freedom);

/// The mean of independent samples of one distribution. NaN marks quantities that the samples do not determine: the
/// mean of none, the scatter of one.
struct MeanEstimate {
  static constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

  std::int64_t samples = 0;
  double mean = unknown;
  double standard_deviation = unknown;  ///< of the distribution, from n - 1
  double standard_error = unknown;      ///< of the mean
  double half_width = unknown;          ///< the mean lies within mean +- half_width with the wanted confidence

  [[nodiscard]] double low() const { return mean - half_width; }
  [[nodiscard]] double high() const { return mean + half_width; }
};

/// The interval is Student's: exact for a normal distribution.
/// \param confidence in (0, 1)
MeanEstimate estimate_mean(std::span<const double> samples, double confidence);

/// y = intercept + slope x.
struct LineFit {
  double intercept = 0;
  double slope = 0;
  double intercept_error = 0;  ///< standard errors, from those of y
  double slope_error = 0;
};

/// The line of least squares, each y weighted by the inverse square of its standard error.
/// \param y_errors > 0; all three of one length >= 2, with two different x
LineFit fit_line(std::span<const double> x, std::span<const double> y, std::span<const double> y_errors);

}  // namespace equidem
