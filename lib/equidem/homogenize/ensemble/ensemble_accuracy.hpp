// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Number and size of random cells: the cheapest ensemble that determines the moduli to an accuracy.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "equidem/core/error.hpp"
#include "equidem/homogenize/ensemble/ensemble.hpp"
#include "equidem/homogenize/ensemble/ensemble_statistics.hpp"

namespace equidem {

struct EnsembleAccuracy {
  double accuracy = 0.01;    ///< > 0: of K and G relative, of nu (plane strain) as it is
  double confidence = 0.95;  ///< that all three are met
  std::uint64_t first_seed = 1;
  std::int64_t smallest = 32;  ///< discs in the smallest cells that are tried
  double most_discs = 1e8;     ///< in all cells together
};

/// Cells of one size and their number.
struct EnsembleSetting {
  std::int64_t discs = 0;
  int samples = 0;

  [[nodiscard]] double all_discs() const { return static_cast<double>(discs) * samples; }
  /// Work to sample them, in discs: elimination of a plane network of N takes slightly more than N, as N^1.1.
  [[nodiscard]] double work() const;
};

struct AccurateEnsemble {
  EnsembleSetting chosen;
  EnsemblePlan plan;                    ///< of all sizes sampled; samples is that of the chosen size
  std::vector<EnsembleSample> samples;  ///< pilot cells too
  EnsembleStatistics statistics;        ///< of all sizes sampled
  double estimated = 0;            ///< error of the mean of the chosen cells: scatter and drift, the worst of the three
  EnsembleSetting ten_times_more;  ///< setting that reaches a tenth of the wanted error
  bool stopped = false;            ///< by the user, before the end
  std::optional<Error> failure;    ///< the accuracy is not reached; the rest is that of the cells sampled
};

/// The cells that are sampled first.
std::array<EnsembleSetting, 2> accuracy_pilots(const EnsembleAccuracy& options);

/// Small cells of two sizes give scatter and drift; the cheapest size and number follow from
///
///   P(|normal(drift/N, s)| > accuracy), summed over K, G and nu, <= 1 - confidence,   s² = amplitude²/(N S) + (error
///   of drift)²/N²,
///
/// at least eight cells; they are sampled, and more of them until their own scatter reaches the accuracy. The choice
/// depends on the samples alone, not on the clock.
/// That it takes more discs than most_discs, with what can be reached, or that no two cells have moduli is a failure in
/// the result.
AccurateEnsemble sample_to_accuracy(const CellSampler& sampler, const EnsembleAccuracy& options,
                                    const std::function<void(const std::vector<EnsembleSample>& done)>& save = {});

}  // namespace equidem
