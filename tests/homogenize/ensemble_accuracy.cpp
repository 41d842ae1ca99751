// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The accuracy asked of an ensemble is kept, at little more than the least cost, on cells whose true moduli are known.
#include "equidem/homogenize/ensemble/ensemble_accuracy.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <mutex>
#include <utility>
#include <vector>

#include "equidem/assembly/delaunay.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/random.hpp"
#include "equidem/homogenize/effective_stiffness.hpp"

#include "support/catch.hpp"
#include "support/requests.hpp"

using namespace equidem;

namespace {

constexpr std::size_t judged = 3;

/// Random cells, each made once: seeds repeat after `different` of them, so that many requests share a few cells.
class Cells {
 public:
  HomogenizedCell operator()(std::int64_t discs, std::uint64_t seed) {
    const std::pair key{discs, seed % different(discs)};
    {
      const std::lock_guard lock(mutex_);
      if (const auto known = cells_.find(key); known != cells_.end()) return known->second;
    }
    const Assembly cell = delaunay_assembly({.discs = discs, .seed = key.second + 1, .periodic = true});
    const HomogenizedCell made{
        static_cast<std::int64_t>(cell.size()),
        effective_moduli(effective_stiffness(cell, ContactSprings(SpringConstants{1e9, 0.3e9})).stiffness)};
    const std::lock_guard lock(mutex_);
    return cells_.emplace(key, made).first->second;
  }

  static std::uint64_t different(std::int64_t discs) {
    return static_cast<std::uint64_t>(std::max<std::int64_t>(1, 60000 / discs));
  }

 private:
  std::mutex mutex_;
  std::map<std::pair<std::int64_t, std::uint64_t>, HomogenizedCell> cells_;
};

double measure(std::size_t q, double error, double truth) {
  return std::abs(error) / (ensemble_quantities[q].modulus ? truth : 1);
}

/// Probability that a normal error of the mean `drift` and the deviation `scatter` is within the accuracy.
double within(double accuracy, double drift, double scatter) {
  const auto below = [](double x) { return 0.5 * std::erfc(-x / std::sqrt(2.0)); };
  return below((accuracy - drift) / scatter) - below((-accuracy - drift) / scatter);
}

std::array<double, judged> means_of(const std::vector<EnsembleSample>& samples, std::int64_t discs) {
  std::array<double, judged> means{};
  double count = 0;
  for (const EnsembleSample& sample : samples) {
    if (sample.discs != discs) continue;
    count += 1;
    for (std::size_t q = 0; q < judged; ++q) means[q] += sample.cell.moduli.*ensemble_quantities[q].value;
  }
  for (double& mean : means) mean /= count;
  return means;
}

}  // namespace

TEST_CASE("accuracy_asked_of_random_cells_is_kept_at_most_twice_the_least_cost") {
  Cells cells;
  const CellSampler sampler = [&cells](std::int64_t discs, std::uint64_t seed) { return cells(discs, seed); };
  const auto sampled = [&](std::int64_t discs) {
    return sample_ensemble({.discs = {discs}, .samples = static_cast<int>(Cells::different(discs)), .first_seed = 0},
                           sampler);
  };
  // The truth: the mean of large cells. Scatter and drift of small ones: from all there are.
  constexpr std::int64_t large = 512;
  EnsembleStatistics known;
  {
    EnsembleSamples all = sampled(32);
    const EnsembleSamples reference = sampled(large);
    all.samples.insert(all.samples.end(), reference.samples.begin(), reference.samples.end());
    known = analyze_ensemble({.discs = {32, large}}, all.samples, 0.95);
  }
  std::array<double, judged> truth{}, drift{}, scatter{};
  for (std::size_t q = 0; q < judged; ++q) {
    truth[q] = known.sizes.back().estimates[q].mean;
    drift[q] = measure(q, known.dependence[q].drift, truth[q]);
    scatter[q] = measure(q, known.dependence[q].amplitude, truth[q]);
  }

  Random random(501);
  constexpr int requests = 200;
  int kept = 0, cheap = 0, estimated_in_vain = 0;
  double dearest = 0;
  for (int k = 0; k < requests; ++k) {
    const double accuracy = 0.008 * std::pow(5.0, random.uniform());
    const std::uint64_t seed = random.below(60000);
    const AccurateEnsemble got = sample_to_accuracy(sampler, {.accuracy = accuracy, .first_seed = seed});
    const auto means = means_of(got.samples, got.chosen.discs);
    bool met = true;
    for (std::size_t q = 0; q < judged; ++q) met = met && measure(q, means[q] - truth[q], truth[q]) <= accuracy;
    kept += met ? 1 : 0;
    estimated_in_vain += got.estimated > accuracy ? 1 : 0;

    double least = 0;
    for (std::int64_t discs = 32; discs <= 4096; discs += std::int64_t{1} << (static_cast<int>(std::log2(discs)) - 1)) {
      const auto n = static_cast<double>(discs);
      for (int count = 8; count <= 2000; count += std::max(1, count / 16)) {
        const EnsembleSetting setting{discs, count};
        if (least > 0 && setting.work() >= least) break;
        bool does = true;
        for (std::size_t q = 0; q < judged; ++q)
          does = does && within(accuracy, drift[q] / n, scatter[q] / std::sqrt(n * count)) >= 0.95;
        if (does) least = setting.work();
      }
    }
    const double dearer = got.chosen.work() / least;
    dearest = std::max(dearest, dearer);
    cheap += dearer <= 2 ? 1 : 0;
  }
  CAPTURE(truth[0], truth[1], truth[2], drift[0], drift[1], drift[2], scatter[0], scatter[1], scatter[2], dearest);
  CHECK(estimated_in_vain == 0);
  CAPTURE(kept, cheap, requests);
  CHECK(kept >= 0.95 * requests);
  CHECK(cheap >= 0.95 * requests);
  write_down(
      {.task = "equidem homogenize: moduli of random cells", .requests = requests, .kept = kept, .cheap = cheap});
}

TEST_CASE("accuracy_of_cells_beyond_all_means_is_refused_with_what_can_be_reached") {
  const CellSampler sampler = [](std::int64_t discs, std::uint64_t seed) {
    Random random(seed + static_cast<std::uint64_t>(discs));
    HomogenizedCell cell{discs, {}};
    cell.moduli.bulk_modulus_2d = cell.moduli.shear_modulus =
        1 + (random.uniform() - 0.5) / std::sqrt(static_cast<double>(discs));
    return cell;
  };
  try {
    sample_to_accuracy(sampler, {.accuracy = 1e-5, .most_discs = 1e5});
    FAIL("1e-5 of at most 1e5 discs");
  } catch (const Error& error) {
    CHECK(error.kind() == ErrorKind::computation_failed);
    CHECK_THAT(error.what(), Catch::Contains("1e-05 cannot be reached") && Catch::Contains("about 0.00"));
  }
}
