// SPDX-License-Identifier: GPL-3.0-or-later
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "equidem/assembly/lattices.hpp"
#include "equidem/breakage/calibrate/strength_test.hpp"
#include "equidem/core/progress.hpp"
#include "equidem/core/stopwatch.hpp"

#include "breakage/breakage.hpp"

namespace equidem::breakage {
namespace {

/// Lengths of notches: up to this share of the width; exponents of a alone are those of notches from so many distances
/// of neighbours on.
constexpr double largest_share = 0.6, least_length = 12;

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

/// Least squares y = A + p ln(a + c); with c where the sum of squares is least.
struct ShiftedLine {
  double shift = 0, shift_error = 0, slope = 0, slope_error = 0, intercept = 0, intercept_error = 0;
};

/// Inverse of a symmetric 3 x 3 matrix, of which the diagonal is wanted.
std::array<double, 3> diagonal_of_inverse(const std::array<double, 6>& m) {  // 00 01 02 11 12 22
  const auto [a, b, c, d, e, f] = m;
  const double det = a * (d * f - e * e) - b * (b * f - c * e) + c * (b * e - c * d);
  return {(d * f - e * e) / det, (a * f - c * c) / det, (a * d - b * b) / det};
}

/// \param slope none: it is found, too
ShiftedLine fit_shifted(const std::vector<double>& half, const std::vector<double>& y, std::optional<double> slope) {
  const std::vector<double> equal(y.size(), 1.0);
  const auto count = static_cast<double>(y.size());
  const auto line_at = [&](double shift) {
    std::vector<double> x;
    for (const double a : half) x.push_back(std::log(a + shift));
    LineFit line;
    if (slope) {
      for (std::size_t k = 0; k < y.size(); ++k) line.intercept += (y[k] - *slope * x[k]) / count;
      line.slope = *slope;
    } else {
      line = fit_line(x, y, equal);
    }
    double square = 0;
    for (std::size_t k = 0; k < y.size(); ++k) square += squared(y[k] - line.intercept - line.slope * x[k]);
    return std::pair(line, square);
  };
  double low = -0.9 * half.front(), high = 3;
  const double golden = 0.5 * (std::sqrt(5.0) - 1);
  for (int k = 0; k < 100; ++k) {
    const double first = high - golden * (high - low), second = low + golden * (high - low);
    (line_at(first).second < line_at(second).second ? high : low) =
        line_at(first).second < line_at(second).second ? second : first;
  }
  const double shift = 0.5 * (low + high);
  const auto [line, square] = line_at(shift);
  // Derivatives by A, p and c.
  std::array<double, 6> normal{};
  for (const double a : half) {
    const double x = slope ? 0 : std::log(a + shift), by_shift = line.slope / (a + shift);
    const double row[] = {1, x, by_shift};
    for (int r = 0, n = 0; r < 3; ++r)
      for (int c = r; c < 3; ++c, ++n) normal[n] += row[r] * row[c];
  }
  if (slope) normal[3] = 1;
  const double variance = square / (count - (slope ? 2 : 3));
  const auto inverse = diagonal_of_inverse(normal);
  const auto error = [&](int k) { return std::sqrt(variance * inverse[static_cast<std::size_t>(k)]); };
  return {shift, error(2), line.slope, slope ? 0 : error(1), line.intercept, error(0)};
}

NotchFit fit_of(const std::vector<NotchedPlate>& plates, std::int64_t columns, double ratio, double lattice) {
  NotchFit fit{.columns = columns, .ratio = ratio, .griffith = griffith_toughness(ratio), .lattice = lattice};
  std::vector<double> half, y, long_x, long_y;
  for (const NotchedPlate& one : plates) {
    if (one.columns != columns || one.ratio != ratio) continue;
    half.push_back(0.5 * one.length);
    y.push_back(std::log(one.toughness) - 0.5 * std::log(std::numbers::pi * half.back()));  // of sigma sqrt(sec)
    if (one.length < least_length) continue;
    long_x.push_back(std::log(half.back()));
    long_y.push_back(y.back());
  }
  const ShiftedLine as_root = fit_shifted(half, y, -0.5), free = fit_shifted(half, y, {});
  fit.exponent = free.slope;
  fit.exponent_error = free.slope_error;
  fit.shift = as_root.shift;
  fit.shift_error = as_root.shift_error;
  fit.toughness = std::exp(as_root.intercept) * std::sqrt(std::numbers::pi);
  fit.toughness_error = fit.toughness * as_root.intercept_error;
  if (long_x.size() < 3) return fit;
  const LineFit line = fit_line(long_x, long_y, std::vector<double>(long_x.size(), 1.0));
  double square = 0;
  for (std::size_t k = 0; k < long_x.size(); ++k)
    square += squared(long_y[k] - line.intercept - line.slope * long_x[k]);
  fit.plain_exponent = line.slope;
  fit.plain_exponent_error = line.slope_error * std::sqrt(square / static_cast<double>(long_x.size() - 2));
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
    const double lattice = lattice_toughness(ratio, quick);
    for (const std::int64_t columns : sizes) found.fits.push_back(fit_of(found.plates, columns, ratio, lattice));
  }
  found.seconds = watch.seconds();
  return found;
}

}  // namespace equidem::breakage
