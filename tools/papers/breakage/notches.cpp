// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>

#include "equidem/assembly/lattices.hpp"
#include "equidem/breakage/calibrate/strength_test.hpp"
#include "equidem/core/progress.hpp"
#include "equidem/core/stopwatch.hpp"

#include "breakage/breakage.hpp"

namespace equidem::breakage {
namespace {

/// Lengths between which the continuum is that of a plate: distances of neighbours, and the share of the width.
constexpr double least_length = 12, largest_share = 0.6;

NotchedPlate plate_of(std::int64_t columns, double ratio, int cut) {
  const double radius = 0.5;
  const auto width = static_cast<double>(columns);
  Assembly plate = hexagonal_lattice({.columns = static_cast<std::int32_t>(columns),
                                      .rows = static_cast<std::int32_t>(2 * std::lround(width / std::sqrt(3.0)) * 2),
                                      .radius = radius});
  const StrengthSample sample(std::move(plate), ContactSprings(SpringConstants{1e9, ratio * 1e9}),
                              {.fallen_to = test_over});
  ContactStrengths strengths;
  strengths.tension.assign(sample.assembly().contacts.size(), 1);
  strengths.shear.assign(sample.assembly().contacts.size(), 1e6);
  const double notch = cut * 2 * radius;
  const SampleStrength found = sample.strength(StrengthTestKind::tension, strengths, notch);
  const double distance = 2 * radius;
  return {.columns = columns,
          .discs = std::ssize(sample.assembly().centres),
          .ratio = ratio,
          .notch = notch / sample.width(),
          .length = notch / distance,
          .strength = found.stress * distance,
          .toughness = notch_toughness(found.stress, notch, sample.width()) * std::sqrt(distance),
          .energy_error = found.energy_error};
}

/// Two bonds break for each d of a crack along a row, each with the energy f_t²/(2 kN) at least, so that
/// K² = E G >= E f_t²/(kN d), E = 4 K G/(K + G) in the plane, G = sqrt3/4 (kN + kT), K = sqrt3/2 kN.
double griffith_toughness(double ratio) {
  const double shear = 0.25 * std::sqrt(3.0) * (1 + ratio), bulk = 0.5 * std::sqrt(3.0);
  return std::sqrt(4 * bulk * shear / (bulk + shear));
}

NotchFit fit_of(const std::vector<NotchedPlate>& plates, std::int64_t columns, double ratio) {
  NotchFit fit{.columns = columns, .ratio = ratio, .griffith = griffith_toughness(ratio)};
  std::vector<double> x, y, toughness;
  for (const NotchedPlate& one : plates) {
    if (one.columns != columns || one.ratio != ratio) continue;
    if (one.length < least_length || one.notch > largest_share) continue;
    x.push_back(std::log(one.length));
    y.push_back(std::log(one.toughness) - 0.5 * std::log(one.length));  // of sigma sqrt(sec), but for a constant
    toughness.push_back(one.toughness);
  }
  if (x.size() < 3) return fit;
  const std::vector<double> equal(x.size(), 1.0);
  const LineFit line = fit_line(x, y, equal);
  double square = 0;
  for (std::size_t k = 0; k < x.size(); ++k) square += squared(y[k] - line.intercept - line.slope * x[k]);
  fit.exponent = line.slope;
  fit.exponent_error = line.slope_error * std::sqrt(square / static_cast<double>(x.size() - 2));
  fit.toughness = estimate_mean(toughness, 0.95);
  return fit;
}

}  // namespace

Notches notched_plates(bool quick) {
  const std::vector<std::int64_t> sizes =
      quick ? std::vector<std::int64_t>{21, 41} : std::vector<std::int64_t>{41, 81, 121};
  const std::vector<int> cuts{2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64, 96};
  struct Job {
    std::int64_t columns;
    double ratio;
    int cut;
  };
  std::vector<Job> jobs;
  for (const double ratio : {0.0, 0.4}) {
    for (const std::int64_t columns : sizes) {
      for (const int cut : cuts) {
        if (cut <= largest_share * static_cast<double>(columns)) jobs.push_back({columns, ratio, cut});
      }
    }
  }
  const Stopwatch watch;
  Notches found;
  found.plates.resize(jobs.size());
  Progress progress("notched plates:");
  for (std::size_t k = 0; k < jobs.size(); ++k) {
    found.plates[k] = plate_of(jobs[k].columns, jobs[k].ratio, jobs[k].cut);
    progress.update(static_cast<double>(k + 1) / static_cast<double>(jobs.size()));
  }
  for (const double ratio : {0.0, 0.4}) {
    for (const std::int64_t columns : sizes) {
      NotchFit fit = fit_of(found.plates, columns, ratio);
      if (fit.toughness.samples > 0) found.fits.push_back(std::move(fit));
    }
  }
  found.seconds = watch.seconds();
  return found;
}

}  // namespace equidem::breakage
