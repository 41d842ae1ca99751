// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/core/statistics.hpp"

#include <cassert>
#include <cmath>
#include <numeric>

#include <boost/math/distributions/students_t.hpp>

namespace equidem {
double student_critical_value(double confidence, std::int64_t degrees_of_freedom) {
  assert(confidence > 0 && confidence < 1 && degrees_of_freedom >= 1);
  const boost::math::students_t distribution(static_cast<double>(degrees_of_freedom));
  return boost::math::quantile(boost::math::complement(distribution, 0.5 * (1 - confidence)));
}

MeanEstimate estimate_mean(std::span<const double> samples, double confidence) {
  MeanEstimate estimate;
  estimate.samples = static_cast<std::int64_t>(samples.size());
  if (samples.empty()) return estimate;
  const auto n = static_cast<double>(samples.size());
  estimate.mean = std::accumulate(samples.begin(), samples.end(), 0.0) / n;
  if (samples.size() < 2) return estimate;
  double squares = 0;
  for (const double sample : samples) squares += (sample - estimate.mean) * (sample - estimate.mean);
  estimate.standard_deviation = std::sqrt(squares / (n - 1));
  estimate.standard_error = estimate.standard_deviation / std::sqrt(n);
  estimate.half_width = student_critical_value(confidence, estimate.samples - 1) * estimate.standard_error;
  return estimate;
}

LineFit fit_line(std::span<const double> x, std::span<const double> y, std::span<const double> y_errors) {
  assert(x.size() >= 2 && x.size() == y.size() && x.size() == y_errors.size());
  double weights = 0, x_mean = 0, y_mean = 0;
  for (std::size_t k = 0; k < x.size(); ++k) {
    const double weight = 1 / (y_errors[k] * y_errors[k]);
    weights += weight;
    x_mean += weight * x[k];
    y_mean += weight * y[k];
  }
  x_mean /= weights;
  y_mean /= weights;
  double xx = 0, xy = 0;
  for (std::size_t k = 0; k < x.size(); ++k) {
    const double weight = 1 / (y_errors[k] * y_errors[k]);
    xx += weight * (x[k] - x_mean) * (x[k] - x_mean);
    xy += weight * (x[k] - x_mean) * (y[k] - y_mean);
  }
  assert(xx > 0);
  LineFit fit;
  fit.slope = xy / xx;
  fit.intercept = y_mean - fit.slope * x_mean;
  fit.slope_error = std::sqrt(1 / xx);
  fit.intercept_error = std::sqrt(1 / weights + x_mean * x_mean / xx);
  return fit;
}

}  // namespace equidem
