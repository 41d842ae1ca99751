// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Sampling loses nothing and changes no bit; statistics of cells whose true moduli are known.
#include "equidem/homogenize/ensemble/ensemble.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "equidem/assembly/delaunay.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/random.hpp"
#include "equidem/homogenize/effective_stiffness.hpp"
#include "equidem/homogenize/ensemble/ensemble_statistics.hpp"

#include "support/catch.hpp"
#include "support/fields.hpp"

using namespace equidem;

namespace {

constexpr std::size_t K = 0, G = 1, nu = 2;

/// Cells of which all is known: mean = truth + drift/N, normal scatter of the size amplitude/sqrt(N).
struct KnownCells {
  double truth = 5;
  double drift = 0;
  double amplitude = 2;

  HomogenizedCell operator()(std::int64_t discs, std::uint64_t seed) const {
    Random random(seed * 1000003 + static_cast<std::uint64_t>(discs));
    const double radius = std::sqrt(-2 * std::log(1 - random.uniform()));
    const double normal = radius * std::cos(2 * std::numbers::pi * random.uniform());
    const auto n = static_cast<double>(discs);
    HomogenizedCell cell{.discs = discs, .moduli = {}};
    cell.moduli.shear_modulus = truth + drift / n + normal * amplitude / std::sqrt(n);
    cell.moduli.bulk_modulus_2d = 2 * truth;
    cell.moduli.poisson_strain = 0.25;
    return cell;
  }
};

Assembly random_cell(PointProcess points, std::int64_t discs, std::uint64_t seed, double largest_radius = 0.005) {
  return delaunay_assembly({.discs = discs,
                            .points = points,
                            .disorder = 0.3,
                            .seed = seed,
                            .radii = {.smallest = 0.005, .largest = largest_radius},
                            .periodic = true});
}

bool same_bits(const std::vector<EnsembleSample>& a, const std::vector<EnsembleSample>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const EnsembleSample& s, const EnsembleSample& t) {
    return s.discs == t.discs && s.seed == t.seed && s.refusal == t.refusal && s.cell.discs == t.cell.discs &&
           s.cell.moduli.shear_modulus == t.cell.moduli.shear_modulus;
  });
}

}  // namespace

TEST_CASE("an_ensemble_holds_every_size_and_seed_once_in_order_for_every_number_of_threads") {
  const EnsemblePlan plan{.discs = {10, 40, 90}, .samples = 7, .first_seed = 5};
  const test::ThreadsFor threads(GENERATE(1, 2, 5));
  const EnsembleSamples result = sample_ensemble(plan, KnownCells{});
  CHECK_FALSE(result.stopped);
  REQUIRE(result.samples.size() == 21);
  for (std::size_t k = 0; k < result.samples.size(); ++k) {
    const EnsembleSample& sample = result.samples[k];
    CAPTURE(k, sample.discs, sample.seed);
    CHECK(sample.discs == plan.discs[k / 7]);
    CHECK(sample.seed == 5 + k % 7);
    CHECK(sample.cell.moduli.shear_modulus == KnownCells{}(sample.discs, sample.seed).moduli.shear_modulus);
  }
}

TEST_CASE("an_ensemble_that_was_stopped_and_continued_has_the_bits_of_one_that_was_not") {
  const EnsemblePlan plan{.discs = {10, 40}, .samples = 8, .first_seed = 1};
  const test::ThreadsFor threads(GENERATE(1, 3));
  const auto whole = sample_ensemble(plan, KnownCells{}).samples;
  const int stop_after = GENERATE(0, 1, 7, 11, 15);
  std::atomic<int> computed{0};
  const EnsembleSamples part = sample_ensemble(plan, [&](std::int64_t discs, std::uint64_t seed) {
    if (computed++ >= stop_after) throw Error(ErrorKind::interrupted, "stopped", "", "");
    return KnownCells{}(discs, seed);
  });
  CHECK(part.stopped);
  CHECK(part.samples.size() == static_cast<std::size_t>(stop_after));

  computed = 0;
  std::vector<EnsembleSample> saved;
  const EnsembleSamples rest = sample_ensemble(
      plan,
      [&](std::int64_t discs, std::uint64_t seed) {
        ++computed;
        return KnownCells{}(discs, seed);
      },
      part.samples, [&](const std::vector<EnsembleSample>& done) { saved = done; });
  CAPTURE(stop_after, computed.load());
  CHECK_FALSE(rest.stopped);
  CHECK(computed == static_cast<int>(whole.size()) - stop_after);
  CHECK(same_bits(rest.samples, whole));
  CHECK(same_bits(saved, whole));
}

TEST_CASE("cells_that_are_refused_are_counted_with_their_reason_and_left_out_of_the_means") {
  const EnsemblePlan plan{.discs = {10}, .samples = 6, .first_seed = 1};
  const auto result = sample_ensemble(plan, [](std::int64_t discs, std::uint64_t seed) {
    if (seed == 3) bad_input("the network is floppy", "2 mechanisms", "Add contacts");
    return KnownCells{}(discs, seed);
  });
  REQUIRE(result.samples.size() == 6);
  CHECK(result.samples[2].refused());
  CHECK(result.samples[2].refusal.find("floppy") != std::string::npos);
  const EnsembleStatistics statistics = analyze_ensemble(plan, result.samples, 0.95);
  CHECK(statistics.sizes[0].refused == 1);
  CHECK(statistics.sizes[0].estimates[G].samples == 5);
  CHECK(statistics.sizes[0].mean_discs == 10);
}

TEST_CASE("scatter_exponent_limit_and_drift_of_known_cells_are_found_within_their_errors") {
  const double drift = GENERATE(0.0, 60.0);
  const KnownCells cells{.truth = 5, .drift = drift, .amplitude = 2};
  constexpr double confidence = 0.9;
  int exponent_right = 0, limit_right = 0, drifting = 0, scaling_kept = 0;
  constexpr int trials = 400;
  for (int trial = 0; trial < trials; ++trial) {
    const EnsemblePlan plan{
        .discs = {50, 200, 800}, .samples = 6, .first_seed = 1 + 6 * static_cast<std::uint64_t>(trial)};
    const auto d = analyze_ensemble(plan, sample_ensemble(plan, cells).samples, confidence).dependence[G];
    REQUIRE(d.measured_exponent);
    const double t = student_critical_value(confidence, d.freedom);
    if (std::abs(*d.measured_exponent - 0.5) <= t * d.exponent_error) ++exponent_right;
    if (std::abs(*d.limit - cells.truth) <= t * d.limit_error) ++limit_right;
    if (d.drifts) ++drifting;
    if (d.exponent == 0.5) ++scaling_kept;
  }
  const double deviation = std::sqrt(confidence * (1 - confidence) / trials);
  CAPTURE(drift, exponent_right, limit_right, drifting, deviation);
  CHECK(exponent_right > (confidence - 4 * deviation) * trials);
  CHECK(scaling_kept == exponent_right);
  // Where the exponent that chance suggested is used, the errors of the limit are off: a few more may miss.
  CHECK(limit_right > (confidence - 6 * deviation) * trials);
  if (drift == 0)
    CHECK(drifting < (1 - confidence + 6 * deviation) * trials);
  else
    CHECK(drifting > 0.9 * trials);
}

TEST_CASE("cells_of_the_needed_size_keep_the_wanted_accuracy_with_the_stated_confidence") {
  const KnownCells cells{.truth = 5, .drift = 0, .amplitude = 2};
  constexpr double confidence = 0.9, accuracy = 0.02;
  const std::int64_t samples = GENERATE(1, 4);
  const EnsemblePlan plan{.discs = {50, 100, 200}, .samples = 200, .first_seed = 1};
  const EnsembleStatistics statistics = analyze_ensemble(plan, sample_ensemble(plan, cells).samples, confidence);
  REQUIRE_FALSE(statistics.dependence[G].drifts);
  const auto discs = needed_discs(statistics, G, accuracy, samples);
  REQUIRE(discs);
  int kept = 0;
  constexpr int trials = 2000;
  for (int trial = 0; trial < trials; ++trial) {
    double mean = 0;
    for (std::int64_t k = 0; k < samples; ++k) {
      const auto seed = static_cast<std::uint64_t>(10000 + trial * samples + k);
      mean += cells(*discs, seed).moduli.shear_modulus / static_cast<double>(samples);
    }
    if (std::abs(mean - cells.truth) <= accuracy * cells.truth) ++kept;
  }
  const double share = static_cast<double>(kept) / trials;
  CAPTURE(samples, *discs, share);
  // The scatter itself is known to 1/sqrt(2 * 597) = 3 %, which moves the share by about 1 %.
  CHECK(std::abs(share - confidence) < 0.01 + 4 * std::sqrt(confidence * (1 - confidence) / trials));
}

TEST_CASE("averaging_cells_does_not_remove_the_drift_with_size") {
  const KnownCells cells{.truth = 5, .drift = 50, .amplitude = 0.2};
  const EnsemblePlan plan{.discs = {50, 200, 800}, .samples = 20, .first_seed = 1};
  const EnsembleStatistics statistics = analyze_ensemble(plan, sample_ensemble(plan, cells).samples, 0.95);
  REQUIRE(statistics.dependence[G].drifts);
  const auto many = needed_discs(statistics, G, 0.01, 1000000);
  REQUIRE(many);
  CAPTURE(*many, statistics.dependence[G].drift);
  CHECK(static_cast<double>(*many) == Approx(50 / (0.01 * 5)).epsilon(0.05));
}

TEST_CASE("one_size_or_cells_that_all_agree_still_give_a_size_and_a_value_of_zero_gives_none") {
  const EnsemblePlan plan{.discs = {100}, .samples = 10, .first_seed = 1};
  const EnsembleStatistics statistics = analyze_ensemble(plan, sample_ensemble(plan, KnownCells{}).samples, 0.95);
  CHECK_FALSE(statistics.dependence[G].measured_exponent);
  CHECK(needed_discs(statistics, G, 0.01, 1).value_or(0) > 100);
  CHECK_FALSE(statistics.dependence[K].scattered);
  CHECK_FALSE(statistics.dependence[nu].scattered);
  CHECK(needed_discs(statistics, K, 0.01, 1) == 100);

  const EnsembleStatistics about_zero =
      analyze_ensemble(plan, sample_ensemble(plan, KnownCells{.truth = 0}).samples, 0.9999);
  CHECK_FALSE(needed_discs(about_zero, G, 0.01, 1));
}

TEST_CASE("cells_of_springs_h_over_l_with_kT_equal_to_kN_and_rotation_restrained_are_isotropic_without_scatter") {
  // The facets of Voronoi (power) cells obey sum h l n n = A: every gradient H gives the stress kN H and no force is
  // left on any disc (Bolander & Saito 1998).
  const PointProcess points =
      GENERATE(PointProcess::perturbed_hexagonal, PointProcess::poisson_disc, PointProcess::uniform);
  const double largest_radius = GENERATE(0.005, 0.007);
  constexpr double kN = 3e8;
  const auto homogenize = [&](std::int64_t discs, std::uint64_t seed) {
    const Assembly cell = random_cell(points, discs, seed, largest_radius);
    const ContactSprings springs = contact_springs(cell, {kN, kN}, SpringWeighting::voronoi);
    const EffectiveStiffness effective =
        effective_stiffness(cell, springs, {.rotation = Rotation::restrained, .solver = {}});
    double worst = 0;
    for (std::size_t a = 0; a < 4; ++a)
      for (std::size_t b = 0; b < 4; ++b)
        worst = std::max(worst, std::abs(effective.gradient_stiffness[a][b] / kN - (a == b ? 1 : 0)));
    CAPTURE(to_string(points), largest_radius, discs, seed, worst);
    CHECK(worst < 1e-12);
    return HomogenizedCell{static_cast<std::int64_t>(cell.size()), effective_moduli(effective.stiffness)};
  };
  const EnsemblePlan plan{.discs = {20, 60, 200}, .samples = 6, .first_seed = 1};
  const test::ThreadsFor one(1);  // the checks inside belong to one thread
  const EnsembleSamples sampled = sample_ensemble(plan, homogenize);
  const EnsembleStatistics statistics = analyze_ensemble(plan, sampled.samples, 0.95);
  for (const EnsembleSize& size : statistics.sizes) {
    CAPTURE(to_string(points), size.discs, size.refused);
    CHECK(size.refused == 0);
    const auto& e = size.estimates;
    CHECK(e[K].mean == Approx(kN / 2).epsilon(1e-12));
    CHECK(e[G].mean == Approx(kN / 2).epsilon(1e-12));
    CHECK(std::abs(e[nu].mean) < 1e-12);
    CHECK(e[K].standard_deviation < 1e-12 * kN);
    CHECK(e[G].standard_deviation < 1e-12 * kN);
    CHECK(e[nu].standard_deviation < 1e-12);
  }
  for (const std::size_t q : {K, G, nu}) CHECK_FALSE(statistics.dependence[q].scattered);
}

TEST_CASE("scatter_of_real_cells_falls_as_one_over_the_root_of_their_size") {
  const PointProcess points = GENERATE(PointProcess::perturbed_hexagonal, PointProcess::uniform);
  const EnsemblePlan plan{.discs = {64, 256, 1024}, .samples = 80, .first_seed = 1};
  const auto sampled = sample_ensemble(plan, [&](std::int64_t discs, std::uint64_t seed) {
    const Assembly cell = random_cell(points, discs, seed);
    const EffectiveStiffness effective = effective_stiffness(cell, ContactSprings({1, 0.3}));
    return HomogenizedCell{static_cast<std::int64_t>(cell.size()), effective_moduli(effective.stiffness)};
  });
  const EnsembleStatistics statistics = analyze_ensemble(plan, sampled.samples, 0.95);
  for (const std::size_t q : {K, G}) {
    const SizeDependence& d = statistics.dependence[q];
    REQUIRE(d.measured_exponent);
    CAPTURE(to_string(points), ensemble_quantities[q].name, *d.measured_exponent, d.exponent_error);
    CHECK(d.exponent_error < 0.045);
    CHECK(std::abs(*d.measured_exponent - 0.5) < student_critical_value(0.99, d.freedom) * d.exponent_error);
  }
}
