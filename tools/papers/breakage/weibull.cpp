// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "equidem/assembly/lattices.hpp"
#include "equidem/breakage/calibrate/strength_test.hpp"
#include "equidem/core/progress.hpp"
#include "equidem/core/stopwatch.hpp"
#include "equidem/core/threads.hpp"

#include "breakage/breakage.hpp"

namespace equidem::breakage {
namespace {

constexpr double diameter = 1;  // m

/// Discs in a row, tested along x with rotations restrained.
Assembly chain(std::int64_t contacts) {
  Assembly row;
  for (std::int64_t d = 0; d <= contacts; ++d) {
    row.centres.push_back({diameter * static_cast<double>(d), 0});
    row.radii.push_back(0.5 * diameter);
    const auto disc = static_cast<std::int32_t>(d);
    if (d > 0) row.contacts.push_back({disc - 1, disc, 0, 0, 0.5 * diameter, 0.5 * diameter});
  }
  row.groups["left"].discs = {0};
  row.groups["right"].discs = {static_cast<std::int32_t>(contacts)};
  return row;
}

WeibullSize measure(const StrengthSample& sample, double modulus, std::int64_t seeds) {
  std::vector<double> strengths(static_cast<std::size_t>(seeds)), errors(strengths.size());
  const auto first_seed = static_cast<std::uint64_t>(1e6 * modulus);  // other draws for each modulus
  parallel_tasks(strengths.size(), [&](std::size_t k, int) {
    const ContactStrengths drawn = contact_strengths(
        sample.assembly(),
        {.tension = 1, .shear = 2, .friction = 0.5, .weibull_modulus = modulus, .seed = first_seed + k});
    const SampleStrength found = sample.strength(StrengthTestKind::tension, drawn);
    strengths[k] = found.stress * diameter;
    errors[k] = found.energy_error;
  });
  return {.modulus = modulus,
          .contacts = std::ssize(sample.assembly().contacts),
          .strength = estimate_mean(strengths, 0.95),
          .theory = 0,
          .energy_error = *std::ranges::max_element(errors)};
}

}  // namespace

Weibull weibull_samples(bool quick) {
  Weibull found{.chains = {}, .plates = {}, .seeds = quick ? 20 : 100, .seconds_of_chains = 0, .seconds_of_plates = 0};
  const std::int64_t more_seeds = 4 * found.seeds;  // of chains, which take no time
  const std::vector<std::int64_t> lengths{1, 4, 16, 64, 256};
  const std::vector<std::int32_t> columns =
      quick ? std::vector<std::int32_t>{6, 12} : std::vector<std::int32_t>{6, 12, 24, 48};
  const std::vector<double> moduli{2, 4, 8};
  const double count = static_cast<double>(moduli.size() * (lengths.size() + columns.size()));
  double done = 0;
  Progress progress("samples with scatter:");
  const Stopwatch watch;
  for (const double m : moduli) {
    for (const std::int64_t n : lengths) {
      const StrengthSample sample(chain(n), ContactSprings(SpringConstants{1e9, 0.4e9}),
                                  {.axis = LoadAxis::x, .fallen_to = test_over, .rotation = Rotation::restrained});
      found.chains.push_back(measure(sample, m, more_seeds));
      found.chains.back().theory = std::tgamma(1 + 1 / m) * std::pow(static_cast<double>(n), -1 / m);
      progress.update(++done / count);
    }
  }
  found.seconds_of_chains = watch.seconds();
  for (const double m : moduli) {
    for (const std::int32_t n : columns) {
      const StrengthSample sample(hexagonal_lattice({.columns = n, .rows = n, .radius = 0.5 * diameter}),
                                  ContactSprings(SpringConstants{1e9, 0.4e9}), {.fallen_to = scattered_test_over});
      found.plates.push_back(measure(sample, m, found.seeds));
      progress.update(++done / count);
    }
  }
  found.seconds_of_plates = watch.seconds() - found.seconds_of_chains;
  return found;
}

}  // namespace equidem::breakage
