// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/homogenize/ensemble/ensemble_statistics.hpp"

#include <cassert>
#include <cmath>
#include <cstddef>

#include <boost/math/special_functions/digamma.hpp>
#include <boost/math/special_functions/trigamma.hpp>

namespace equidem {
namespace {

/// Scatter below this share of the values is round-off.
constexpr double round_off = 1e-11;

/// Mean and variance of ln(s / sigma), s the standard deviation of nu + 1 normal samples: (psi(nu/2) - ln(nu/2))/2 and
/// psi'(nu/2)/4, psi the digamma function.
struct LogScatter {
  double mean;
  double variance;
};
LogScatter log_scatter(std::int64_t nu) {
  const double half = static_cast<double>(nu) / 2;
  return {(boost::math::digamma(half) - std::log(half)) / 2, boost::math::trigamma(half) / 4};
}

/// Sizes at which one quantity scatters.
struct Scatter {
  std::vector<double> discs, means, samples, deviations;
};

Scatter scatter_of(const std::vector<EnsembleSize>& sizes, std::size_t quantity) {
  Scatter scatter;
  for (const EnsembleSize& size : sizes) {
    const MeanEstimate& e = size.estimates[quantity];
    // Poisson's ratio and anisotropy are numbers of order 1 at most, independent of their mean.
    const double scale = ensemble_quantities[quantity].modulus ? std::abs(e.mean) : 1;
    if (!(e.standard_deviation > round_off * scale)) continue;
    scatter.discs.push_back(size.mean_discs);
    scatter.means.push_back(e.mean);
    scatter.samples.push_back(static_cast<double>(e.samples));
    scatter.deviations.push_back(e.standard_deviation);
  }
  return scatter;
}

void fit_exponent(const Scatter& scatter, double confidence, SizeDependence& result) {
  std::vector<double> x, y, errors;
  for (std::size_t k = 0; k < scatter.discs.size(); ++k) {
    const LogScatter expected = log_scatter(static_cast<std::int64_t>(scatter.samples[k]) - 1);
    x.push_back(std::log(scatter.discs[k]));
    y.push_back(std::log(scatter.deviations[k]) - expected.mean);
    errors.push_back(std::sqrt(expected.variance));
  }
  const LineFit fit = fit_line(x, y, errors);
  result.measured_exponent = -fit.slope;
  result.exponent_error = fit.slope_error;
  const double t = student_critical_value(confidence, result.freedom);
  if (std::abs(*result.measured_exponent - 0.5) > t * fit.slope_error) result.exponent = *result.measured_exponent;
}

/// The scatter of all sizes together, which is known better than that of any one of them.
double pooled_amplitude(const Scatter& scatter, const SizeDependence& dependence) {
  double squares = 0;
  for (std::size_t k = 0; k < scatter.discs.size(); ++k) {
    const double scaled = scatter.deviations[k] * std::pow(scatter.discs[k], dependence.exponent);
    squares += (scatter.samples[k] - 1) * scaled * scaled;
  }
  return std::sqrt(squares / static_cast<double>(dependence.freedom));
}

void fit_drift(const Scatter& scatter, double confidence, SizeDependence& result) {
  std::vector<double> x, errors;
  for (std::size_t k = 0; k < scatter.discs.size(); ++k) {
    x.push_back(1 / scatter.discs[k]);
    errors.push_back(result.amplitude * std::pow(scatter.discs[k], -result.exponent) / std::sqrt(scatter.samples[k]));
  }
  const LineFit fit = fit_line(x, scatter.means, errors);
  result.limit = fit.intercept;
  result.limit_error = fit.intercept_error;
  result.drift = fit.slope;
  result.drift_error = fit.slope_error;
  result.drifts = std::abs(fit.slope) > student_critical_value(confidence, result.freedom) * fit.slope_error;
}

SizeDependence dependence_of(const std::vector<EnsembleSize>& sizes, std::size_t quantity, double confidence) {
  const Scatter scatter = scatter_of(sizes, quantity);
  SizeDependence result;
  result.scattered = !scatter.discs.empty();
  if (!result.scattered) return result;
  for (const double samples : scatter.samples) result.freedom += static_cast<std::int64_t>(samples) - 1;
  const bool several = scatter.discs.front() < scatter.discs.back();
  if (several) fit_exponent(scatter, confidence, result);
  result.amplitude = pooled_amplitude(scatter, result);
  if (several) fit_drift(scatter, confidence, result);
  return result;
}

}  // namespace

EnsembleStatistics analyze_ensemble(const EnsemblePlan& plan, const std::vector<EnsembleSample>& samples,
                                    double confidence) {
  EnsembleStatistics statistics;
  statistics.confidence = confidence;
  for (const std::int64_t discs : plan.discs) {
    EnsembleSize size;
    size.discs = discs;
    std::vector<const EffectiveModuli*> moduli;
    double discs_in_all = 0;
    for (const EnsembleSample& sample : samples) {
      if (sample.discs != discs) continue;
      if (sample.refused()) {
        ++size.refused;
        continue;
      }
      discs_in_all += static_cast<double>(sample.cell.discs);
      moduli.push_back(&sample.cell.moduli);
    }
    size.mean_discs = moduli.empty() ? 0 : discs_in_all / static_cast<double>(moduli.size());
    for (std::size_t q = 0; q < ensemble_quantities.size(); ++q) {
      std::vector<double> values;
      for (const EffectiveModuli* m : moduli) values.push_back(m->*ensemble_quantities[q].value);
      size.estimates[q] = estimate_mean(values, confidence);
    }
    statistics.sizes.push_back(std::move(size));
  }
  for (std::size_t q = 0; q < ensemble_quantities.size(); ++q)
    statistics.dependence[q] = dependence_of(statistics.sizes, q, confidence);
  return statistics;
}

std::optional<std::int64_t> needed_discs(const EnsembleStatistics& statistics, std::size_t quantity, double accuracy,
                                         std::int64_t samples) {
  assert(accuracy > 0 && samples >= 1);
  const EnsembleSize *smallest = nullptr, *largest = nullptr;
  for (const EnsembleSize& size : statistics.sizes) {
    if (size.estimates[quantity].samples == 0) continue;
    if (smallest == nullptr) smallest = &size;
    largest = &size;
  }
  if (smallest == nullptr) return {};
  const SizeDependence& d = statistics.dependence[quantity];
  const auto rounded = [](double discs) { return static_cast<std::int64_t>(std::ceil(discs - 1e-9)); };
  if (!d.scattered) {
    const bool agree = smallest->estimates[quantity].samples > 1;
    return agree ? std::optional(rounded(smallest->mean_discs)) : std::nullopt;
  }
  const double t = student_critical_value(statistics.confidence, d.freedom);
  const double value = d.drifts ? *d.limit : largest->estimates[quantity].mean;
  const double value_error = d.drifts ? d.limit_error
                                      : d.amplitude * std::pow(largest->mean_discs, -d.exponent) /
                                            std::sqrt(static_cast<double>(largest->estimates[quantity].samples));
  if (std::abs(value) <= t * value_error) return {};
  const auto misses = [&](double discs) {
    const double scatter = t * d.amplitude * std::pow(discs, -d.exponent) / std::sqrt(static_cast<double>(samples));
    return scatter + (d.drifts ? std::abs(d.drift) / discs : 0) > accuracy * std::abs(value);
  };
  double low = smallest->mean_discs;
  if (!misses(low)) return rounded(low);
  // A scatter that does not fall with size has no such size.
  constexpr double largest_told = 1e15;
  double high = 2 * low;
  while (high < largest_told && misses(high)) high *= 2;
  if (high >= largest_told) return {};
  while (high - low > 1e-6 * high) {
    const double middle = (low + high) / 2;
    (misses(middle) ? low : high) = middle;
  }
  return rounded(high);
}

}  // namespace equidem
