// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/core/statistics.hpp"

#include <cassert>
#include <cmath>
#include <numbers>
#include <numeric>

namespace equidem {
namespace {

/// P(|T| <= sqrt(nu) tan(angle)) for nu degrees of freedom.
double student_probability(double angle, std::int64_t nu) {
  const double c2 = std::cos(angle) * std::cos(angle);
  const bool odd = nu % 2 != 0;
  // odd:  2/pi {angle + sin (cos + 2/3 cos^3 + ... + 2 4 .. (nu-3) / (3 5 .. (nu-2)) cos^(nu-2))}
  // even: sin {1 + 1/2 cos^2 + ... + 1 3 .. (nu-3) / (2 4 .. (nu-2)) cos^(nu-2)}
  double term = nu == 1 ? 0 : odd ? std::cos(angle) : 1;
  double sum = term;
  for (std::int64_t power = odd ? 3 : 2; power <= nu - 2; power += 2) {
    term *= c2 * static_cast<double>(power - 1) / static_cast<double>(power);
    sum += term;
  }
  sum *= std::sin(angle);
  return odd ? (angle + sum) * 2 / std::numbers::pi : sum;
}

}  // namespace

double student_critical_value(double confidence, std::int64_t degrees_of_freedom) {
  assert(confidence > 0 && confidence < 1 && degrees_of_freedom >= 1);
  double low = 0, high = std::numbers::pi / 2;
  for (;;) {
    const double middle = (low + high) / 2;
    if (middle == low || middle == high) break;
    (student_probability(middle, degrees_of_freedom) < confidence ? low : high) = middle;
  }
  return std::sqrt(static_cast<double>(degrees_of_freedom)) * std::tan(low);
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
