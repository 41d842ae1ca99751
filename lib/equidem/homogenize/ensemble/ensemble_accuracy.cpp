// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/homogenize/ensemble/ensemble_accuracy.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <optional>
#include <utility>

#include "equidem/core/error.hpp"
#include "equidem/core/statistics.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

constexpr std::size_t judged = 3;  // K, G, nu in plane strain
constexpr int small_pilots = 64, large_pilots = 12, fewest_cells = 8;
constexpr std::int64_t pilot_ratio = 8;  // of the sizes of both
constexpr double most_cells = 1e9;
constexpr double aim = 0.98;  // share of the wanted accuracy

/// Estimated error of the mean of one quantity over the cells, in units of the accuracy's measure.
struct Miss {
  double scatter = 0;      ///< standard deviation of a cell of N times sqrt(N)
  double drift = 0;        ///< a cell of N is off by drift/N
  double drift_error = 0;  ///< standard error of the drift
};
using Misses = std::array<Miss, judged>;

double scale_of(const EnsembleStatistics& statistics, std::size_t q) {
  return ensemble_quantities[q].modulus ? std::abs(statistics.sizes.back().estimates[q].mean) : 1;
}

Misses misses_of(const EnsembleStatistics& statistics) {
  constexpr double normal = 1.959963984540054;  // critical value of the normal distribution, 95 %
  Misses misses;
  for (std::size_t q = 0; q < judged; ++q) {
    const SizeDependence& d = statistics.dependence[q];
    if (!d.scattered) continue;
    const double scale = scale_of(statistics, q);
    // The scatter is itself known from a few samples: Student's tails, as a normal distribution with that critical
    // value.
    const double wider = student_critical_value(0.95, d.freedom) / normal;
    const double n = statistics.sizes.back().mean_discs;
    misses[q].scatter = wider * d.amplitude * std::pow(n, 0.5 - d.exponent) / scale;
    // As measured, though its square is too large by its variance: the smaller drift that this leaves makes the
    // estimated error too small in more than one case of twenty.
    misses[q].drift = std::abs(d.drift) / scale;
    misses[q].drift_error = d.drift_error / scale;
  }
  return misses;
}

/// Probability that one of the quantities is off by more than the accuracy, at most (their sum).
double doubt(const Misses& misses, double discs, double cells, double accuracy) {
  const auto above = [](double x) { return 0.5 * std::erfc(x / std::sqrt(2.0)); };
  double sum = 0;
  for (const Miss& miss : misses) {
    const double drift = miss.drift / discs;
    const double scatter = std::hypot(miss.scatter / std::sqrt(discs * cells), miss.drift_error / discs);
    if (scatter > 0)
      sum += above((accuracy - drift) / scatter) + above((accuracy + drift) / scatter);
    else
      sum += drift > accuracy ? 1 : 0;
  }
  return sum;
}

/// The accuracy that those cells reach with that confidence.
double accuracy_of(const Misses& misses, double discs, double cells, double confidence) {
  double low = 0, high = 0;
  for (const Miss& miss : misses)
    high = std::max(high, (miss.drift + 40 * miss.drift_error) / discs + 40 * miss.scatter / std::sqrt(discs * cells));
  while (high - low > 1e-6 * high) {
    const double middle = 0.5 * (low + high);
    (doubt(misses, discs, cells, middle) > 1 - confidence ? low : high) = middle;
  }
  return high;
}

/// Cells of that size that are needed; empty where drift alone is too much.
std::optional<double> cells_needed(const Misses& misses, double discs, double accuracy, double confidence) {
  const auto too_few = [&](double cells) { return doubt(misses, discs, cells, accuracy) > 1 - confidence; };
  double low = fewest_cells, high = low;
  while (too_few(high)) {
    if (high > most_cells) return {};
    low = high;
    high *= 2;
  }
  while (high - low > 1) {
    const double middle = std::floor(0.5 * (low + high));
    (too_few(middle) ? low : high) = middle;
  }
  return high;
}

std::int64_t next_size(std::int64_t discs, std::int64_t smallest) {
  std::int64_t doubled = smallest;
  while (2 * doubled <= discs) doubled *= 2;
  return discs < doubled + doubled / 2 ? doubled + doubled / 2 : 2 * doubled;
}

/// The cheapest setting: sizes are the smallest one times 1, 3/2, 2, 3, 4, ...
EnsembleSetting cheapest(const Misses& misses, const EnsembleAccuracy& options, double accuracy) {
  EnsembleSetting best;
  double least_discs = 0;
  for (std::int64_t discs = options.smallest; static_cast<double>(discs) <= options.most_discs;
       discs = next_size(discs, options.smallest)) {
    const auto cells = cells_needed(misses, static_cast<double>(discs), accuracy, options.confidence);
    if (!cells) continue;
    const double all = *cells * static_cast<double>(discs);
    if (least_discs == 0 || all < least_discs) least_discs = all;
    if (all > options.most_discs || *cells > most_cells) continue;
    const EnsembleSetting setting{discs, static_cast<int>(*cells)};
    if (best.samples == 0 || setting.work() < best.work()) best = setting;
  }
  return best;
}

[[noreturn]] void refuse(const Misses& misses, const EnsembleAccuracy& options) {
  double reached = options.accuracy;
  while (cheapest(misses, options, reached).samples == 0) reached *= 1.1;
  computation_failed(fmt::format("an accuracy of {:.3g} cannot be reached", options.accuracy),
                     fmt::format("its cells would hold more than {:.0e} discs in all, which reach about {:.2g}",
                                 options.most_discs, reached),
                     "Ask for less");
}

class Sampling {
 public:
  Sampling(const CellSampler& sampler, const EnsembleAccuracy& options,
           const std::function<void(const std::vector<EnsembleSample>&)>& save)
      : sampler_(sampler), options_(options), save_(save) {
    result_.plan = {.discs = {}, .first_seed = options.first_seed};
  }

  /// The samples of one size; false: the user stopped them.
  bool sample(const EnsembleSetting& setting) {
    const auto keep = [&](std::vector<EnsembleSample> some) {
      for (const EnsembleSample& sample : result_.samples)
        if (sample.discs != setting.discs) some.push_back(sample);
      std::stable_sort(some.begin(), some.end(), [](const auto& a, const auto& b) { return a.discs < b.discs; });
      return some;
    };
    EnsembleSamples done =
        sample_ensemble({.discs = {setting.discs}, .samples = setting.samples, .first_seed = options_.first_seed},
                        sampler_, result_.samples, [&](const std::vector<EnsembleSample>& some) {
                          if (save_) save_(keep(some));
                        });
    result_.samples = keep(std::move(done.samples));
    auto& sizes = result_.plan.discs;
    if (std::find(sizes.begin(), sizes.end(), setting.discs) == sizes.end()) sizes.push_back(setting.discs);
    std::sort(sizes.begin(), sizes.end());
    result_.plan.samples = setting.samples;
    result_.chosen = setting;
    result_.stopped = done.stopped;
    result_.statistics = analyze_ensemble(result_.plan, result_.samples, options_.confidence);
    if (!done.stopped) check_samples();
    return !done.stopped;
  }

  /// Samples until the accuracy is reached; false: the user stopped it.
  /// \throws Error (computation_failed) where it cannot be reached
  bool go() {
    for (const EnsembleSetting& pilots : accuracy_pilots(options_))
      if (!sample(pilots)) return false;
    EnsembleSetting setting = cheapest(misses_of(result_.statistics), options_, aim * options_.accuracy);
    for (;;) {
      if (setting.samples == 0 || setting.all_discs() > options_.most_discs)
        refuse(misses_of(result_.statistics), options_);
      if (!sample(setting)) return false;
      if (error() <= options_.accuracy) return true;
      // The scatter falls as one over the root of the number of cells; drift, with their size.
      const EnsembleSetting again = cheapest(misses_of(result_.statistics), options_, aim * options_.accuracy);
      setting = again.discs > setting.discs
                    ? again
                    : EnsembleSetting{setting.discs, std::max(setting.samples + 1 + setting.samples / 16,
                                                              again.discs == setting.discs ? again.samples : 0)};
    }
  }

  /// Whether two cells or more of each size have them.
  [[nodiscard]] bool has_moduli() const {
    return std::ranges::all_of(result_.statistics.sizes,
                               [](const EnsembleSize& size) { return size.estimates.front().samples >= 2; });
  }

  /// Accuracy that the chosen cells reach.
  [[nodiscard]] double error() const {
    return accuracy_of(misses_of(result_.statistics), static_cast<double>(result_.chosen.discs), result_.chosen.samples,
                       options_.confidence);
  }

  AccurateEnsemble& result() { return result_; }

 private:
  void check_samples() const {
    for (const EnsembleSize& size : result_.statistics.sizes) {
      if (size.estimates.front().samples >= 2) continue;
      const auto refused = std::find_if(result_.samples.begin(), result_.samples.end(),
                                        [&](const EnsembleSample& s) { return s.discs == size.discs && s.refused(); });
      computation_failed(
          fmt::format("of {} cells of {} discs fewer than two have moduli", result_.plan.samples, size.discs),
          refused == result_.samples.end() ? "" : "the first: " + refused->refusal, "");
    }
  }

  const CellSampler& sampler_;
  const EnsembleAccuracy& options_;
  const std::function<void(const std::vector<EnsembleSample>&)>& save_;
  AccurateEnsemble result_;
};

}  // namespace

double EnsembleSetting::work() const {
  return std::pow(static_cast<double>(discs), 1.1) * samples;
}

std::array<EnsembleSetting, 2> accuracy_pilots(const EnsembleAccuracy& options) {
  return {{{options.smallest, small_pilots}, {pilot_ratio * options.smallest, large_pilots}}};
}

AccurateEnsemble sample_to_accuracy(const CellSampler& sampler, const EnsembleAccuracy& options,
                                    const std::function<void(const std::vector<EnsembleSample>&)>& save) {
  assert(options.accuracy > 0 && options.smallest >= 3);
  Sampling sampling(sampler, options, save);
  AccurateEnsemble& result = sampling.result();
  try {
    if (!sampling.go()) return std::move(result);
  } catch (const Error& error) {
    if (!error.failed()) throw;
    result.failure = error;
    if (!sampling.has_moduli()) return std::move(result);
  }
  result.estimated = sampling.error();
  EnsembleAccuracy all = options;
  all.most_discs = 1e15;
  result.ten_times_more = cheapest(misses_of(result.statistics), all, aim * options.accuracy / 10);
  return std::move(result);
}

}  // namespace equidem
