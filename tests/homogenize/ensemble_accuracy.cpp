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
#include "equidem/core/text.hpp"
#include "equidem/homogenize/effective_stiffness.hpp"

#include "support/catch.hpp"
#include "support/requests.hpp"

using namespace equidem;

namespace {

constexpr std::size_t judged = 3;

/// Random cells, each made once: seeds repeat after `different` of them, so that many requests share a few cells.
class Cells {
 public:
  Cells(PointProcess points, double kT) : points_(points), springs_(SpringConstants{1e9, kT}) {}

  HomogenizedCell operator()(std::int64_t discs, std::uint64_t seed) {
    const std::pair key{discs, seed % different(discs)};
    {
      const std::lock_guard lock(mutex_);
      if (const auto known = cells_.find(key); known != cells_.end()) return known->second;
    }
    const Assembly cell =
        delaunay_assembly({.discs = discs, .points = points_, .seed = key.second + 1, .periodic = true});
    const HomogenizedCell made{static_cast<std::int64_t>(cell.size()),
                               effective_moduli(effective_stiffness(cell, springs_).stiffness)};
    const std::lock_guard lock(mutex_);
    return cells_.emplace(key, made).first->second;
  }

  static std::uint64_t different(std::int64_t discs) {
    return static_cast<std::uint64_t>(std::max<std::int64_t>(1, 120000 / discs));
  }

 private:
  PointProcess points_;
  ContactSprings springs_;
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

/// The error that the means of such cells exceed once in twenty: the sum over the quantities, at most.
double error_of_nineteen_in_twenty(const std::array<double, judged>& drift, const std::array<double, judged>& scatter,
                                   const EnsembleSetting& setting) {
  const auto n = static_cast<double>(setting.discs);
  double low = 0, high = 1;
  while (high - low > 1e-6 * high) {
    const double middle = 0.5 * (low + high);
    double missed = 0;
    for (std::size_t q = 0; q < judged; ++q)
      missed += 1 - within(middle, drift[q] / n, scatter[q] / std::sqrt(setting.all_discs()));
    (missed > 0.05 ? low : high) = middle;
  }
  return high;
}

/// Infinite cells, and how smaller ones scatter around them and drift.
struct Truth {
  std::array<double, judged> values{}, drift{}, scatter{};
};

/// The truth: the limit of the means of small and large cells, of all there are.
Truth truth_of(const CellSampler& sampler) {
  const EnsemblePlan plan{.discs = {32, 512}};
  std::vector<EnsembleSample> all;
  for (const std::int64_t discs : plan.discs) {
    const auto count = static_cast<int>(Cells::different(discs));
    const EnsembleSamples some = sample_ensemble({.discs = {discs}, .samples = count, .first_seed = 0}, sampler);
    all.insert(all.end(), some.samples.begin(), some.samples.end());
  }
  const EnsembleStatistics known = analyze_ensemble(plan, all, 0.95);
  Truth truth;
  for (std::size_t q = 0; q < judged; ++q) {
    truth.values[q] = *known.dependence[q].limit;
    truth.drift[q] = measure(q, known.dependence[q].drift, truth.values[q]);
    truth.scatter[q] = measure(q, known.dependence[q].amplitude, truth.values[q]);
  }
  return truth;
}

/// The least work of cells that keep the accuracy in nineteen cases of twenty.
double least_work(const Truth& truth, double accuracy) {
  double least = 0;
  for (std::int64_t discs = 32; discs <= 4096; discs += std::int64_t{1} << (static_cast<int>(std::log2(discs)) - 1)) {
    const auto n = static_cast<double>(discs);
    for (int count = 8; count <= 2000; count += std::max(1, count / 16)) {
      const EnsembleSetting setting{discs, count};
      if (least > 0 && setting.work() >= least) break;
      bool does = true;
      for (std::size_t q = 0; q < judged; ++q)
        does = does && within(accuracy, truth.drift[q] / n, truth.scatter[q] / std::sqrt(n * count)) >= 0.95;
      if (does) least = setting.work();
    }
  }
  return least;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
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

/// How many requests keep what is promised.
struct Rates {
  int requests = 0, kept = 0, honest = 0, cheap = 0, estimated_in_vain = 0;
  double dearest = 0;                          ///< work over the least
  std::vector<double> over_error, over_bound;  ///< estimates over the error, and over what nineteen in twenty keep

  void count(const Truth& truth, double accuracy, const AccurateEnsemble& got) {
    const auto means = means_of(got.samples, got.chosen.discs);
    double error = 0;
    for (std::size_t q = 0; q < judged; ++q)
      error = std::max(error, measure(q, means[q] - truth.values[q], truth.values[q]));
    const double dearer = got.chosen.work() / least_work(truth, accuracy);
    ++requests;
    kept += error <= accuracy ? 1 : 0;
    honest += error <= got.estimated ? 1 : 0;
    cheap += dearer <= 2 ? 1 : 0;
    estimated_in_vain += got.estimated > accuracy ? 1 : 0;
    dearest = std::max(dearest, dearer);
    over_error.push_back(got.estimated / error);
    over_bound.push_back(got.estimated / error_of_nineteen_in_twenty(truth.drift, truth.scatter, got.chosen));
  }
  [[nodiscard]] double percent(int count) const { return 100.0 * count / requests; }
};

}  // namespace

TEST_CASE("accuracy_asked_of_random_cells_is_kept_at_most_twice_the_least_cost_and_the_estimate_holds") {
  constexpr int requests_of_each = 80;
  constexpr std::array kinds = {std::pair{PointProcess::poisson_disc, 0.3e9},
                                std::pair{PointProcess::poisson_disc, 1e7}, std::pair{PointProcess::uniform, 0.05e9}};
  Rates rates;
  for (const auto& [points, kT] : kinds) {
    Cells cells(points, kT);
    const CellSampler sampler = [&cells](std::int64_t discs, std::uint64_t seed) { return cells(discs, seed); };
    const Truth truth = truth_of(sampler);
    Random random(501);
    for (int k = 0; k < requests_of_each; ++k) {
      const double accuracy = truth.scatter[0] * 0.03 * std::pow(10.0, random.uniform());
      const AccurateEnsemble got =
          sample_to_accuracy(sampler, {.accuracy = accuracy, .first_seed = random.below(60000)});
      rates.count(truth, accuracy, got);
    }
  }
  const double pessimism = median(rates.over_bound), over_error = median(rates.over_error);
  fmt::print(
      "{} requests: within the accuracy asked {:.1f} %, within the estimate {:.1f} %, at most twice the least cost "
      "{:.1f} %;\nmedian of the estimate over the error that nineteen in twenty keep: {:.2f}, over the error: {:.2f}\n",
      rates.requests, rates.percent(rates.kept), rates.percent(rates.honest), rates.percent(rates.cheap), pessimism,
      over_error);
  CAPTURE(rates.requests, rates.kept, rates.honest, rates.cheap, rates.dearest, pessimism, over_error);
  CHECK(rates.estimated_in_vain == 0);
  CHECK(rates.percent(rates.kept) >= 95);
  CHECK(rates.percent(rates.honest) >= 95);
  CHECK(rates.percent(rates.cheap) >= 95);
  CHECK(pessimism <= 2);
  write_down({.task = "equidem homogenize: moduli of random cells",
              .requests = rates.requests,
              .kept = rates.kept,
              .cheap = rates.cheap,
              .honest = rates.honest});
}

TEST_CASE("accuracy_of_cells_beyond_all_means_gives_the_cells_sampled_and_what_can_be_reached") {
  const CellSampler sampler = [](std::int64_t discs, std::uint64_t seed) {
    Random random(seed + static_cast<std::uint64_t>(discs));
    HomogenizedCell cell{discs, {}};
    cell.moduli.bulk_modulus_2d = cell.moduli.shear_modulus =
        1 + (random.uniform() - 0.5) / std::sqrt(static_cast<double>(discs));
    return cell;
  };
  const AccurateEnsemble reached = sample_to_accuracy(sampler, {.accuracy = 1e-5, .most_discs = 1e5});
  REQUIRE(reached.failure);
  CHECK(reached.failure->kind() == ErrorKind::computation_failed);
  CHECK_THAT(reached.failure->what(), Catch::Contains("1e-05 cannot be reached") && Catch::Contains("about 0.00"));
  CHECK(reached.samples.size() >= 76);
  CHECK(reached.estimated > 1e-5);
}
