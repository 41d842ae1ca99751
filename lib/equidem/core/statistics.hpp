// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Sums over vectors whose order does not depend on the number of threads.
/// Means of samples, lines through them, and how well both are known.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "equidem/core/threads.hpp"

namespace equidem {

/// The sums of f(begin, end), an array of numbers, over pieces of the range.
template <std::size_t N, typename Function>
std::array<double, N> sums_over(std::size_t count, std::size_t at_once, const Function& f) {
  std::vector<std::array<double, N>> parts((count + at_once - 1) / at_once);
  parallel_ranges(count, at_once, [&](std::size_t begin, std::size_t end) { parts[begin / at_once] = f(begin, end); });
  std::array<double, N> sums{};
  for (const auto& part : parts) {
    for (std::size_t k = 0; k < N; ++k) sums[k] += part[k];
  }
  return sums;
}

/// N sums over [0, count) at once: add(index, sums) adds the terms of one index. Partial sums of a fixed length are
/// added in order: the same bits for every number of threads, and rounding errors that grow far slower than in one
/// long sum.
template <std::size_t N, typename Add>
std::array<double, N> contact_sums(std::size_t count, const Add& add) {
  constexpr std::size_t block = 4096, run = 64;  // equal terms round to the same side: no long run of them
  std::vector<std::array<double, N>> partial((count + block - 1) / block);
  parallel_tasks(partial.size(), [&](std::size_t task, int) {
    const std::size_t end = std::min(count, (task + 1) * block);
    for (std::size_t index = task * block; index < end;) {
      std::array<double, N> sums{};
      for (const std::size_t stop = std::min(end, index + run); index < stop; ++index) add(index, sums);
      for (std::size_t k = 0; k < N; ++k) partial[task][k] += sums[k];
    }
  });
  std::array<double, N> total{};
  for (const auto& sums : partial) {
    for (std::size_t k = 0; k < N; ++k) total[k] += sums[k];
  }
  return total;
}

/// Term by term, on the calling thread.
inline double dot(std::span<const double> a, std::span<const double> b) {
  double sum = 0;
  for (std::size_t k = 0; k < a.size(); ++k) sum += a[k] * b[k];
  return sum;
}

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
