// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Size distributions of the grains of a packing.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "equidem/core/names.hpp"
#include "equidem/core/random.hpp"

namespace equidem {

/// A point of a grading curve.
struct Sieve {
  double diameter = 0;  ///< m
  double passing = 0;   ///< share of the mass that is finer, in [0, 1]
};

/// Radii of grains, by number.
struct SizeDistribution {
  enum class Kind {
    uniform,      ///< radii uniform in [smallest, largest]
    log_normal,   ///< ln(r/median) is normal with the standard deviation `deviation`, cut at three of them
    sieve_curve,  ///< mass between two sieves is spread uniformly over the logarithm of the diameter
  } kind = Kind::uniform;
  double smallest = 0, largest = 0;  ///< uniform: m; equal ones are allowed
  double median = 0, deviation = 0;  ///< log_normal: m, and a number
  std::vector<Sieve> sieves = {};    ///< sieve_curve
};

template <>
struct EnumNames<SizeDistribution::Kind> {
  using enum SizeDistribution::Kind;
  static constexpr const char* what = "distribution of sizes";
  static constexpr NamedValue<SizeDistribution::Kind> list[] = {
      {uniform, "uniform"}, {log_normal, "log_normal"}, {sieve_curve, "sieve_curve"}};
};

/// Whether a length is positive, and its fourth power, as in moments of inertia, is a number.
inline bool is_size(double length) {
  return length >= 1e-60 && length <= 1e60;
}

/// \throws Error (bad_input) on numbers out of range, sieves that do not ascend or do not run from 0 to 1
void check(const SizeDistribution& sizes);

/// A curve of two columns, diameter in m and share passing by mass in [0, 1], ascending, the first share 0, the last 1.
/// A first row of names, empty lines and lines that begin with # are passed over.
/// \throws Error (bad_input) with file and line
std::vector<Sieve> read_sieve_curve(const std::filesystem::path& path);

/// Radii in random order, one from each of `count` parts of equal probability, so that even a few follow the
/// distribution. Only operations that IEEE 754 rounds alike everywhere: a seed gives the same bits on every machine.
/// \return m
std::vector<double> draw_radii(const SizeDistribution& sizes, std::int64_t count, Random& random);

/// Mean of r and of r² over the distribution, m and m²: how many grains cover an area.
struct RadiusMoments {
  double mean = 0, mean_square = 0;
};
RadiusMoments moments_of(const SizeDistribution& sizes);

}  // namespace equidem
