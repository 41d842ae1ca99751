// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Size distributions of the grains of a packing.
///
/// Amount to pack: box and radii from two of number, box and solid fraction.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "equidem/core/names.hpp"
#include "equidem/core/random.hpp"
#include "equidem/packing/packing.hpp"

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
    log_normal,   ///< ln(r/median) is normal with the standard deviation `deviation`, truncated at three times it
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

/// Two of three must be given; of bodies that fall, and of bodies as dense as possible, grains and box.
struct PackingAmount {
  std::optional<std::int64_t> grains = {};    ///< bodies, >= 1
  std::optional<Vec2> box = {};               ///< width and height, m
  std::optional<double> solid_fraction = {};  ///< area of the bodies over that of the box
  double aspect = 1;                          ///< width over height of a box that is left out, > 0
};

/// Draws the radii and completes the box. A box left out is one of the aspect that gives the solid fraction; where the
/// number is left out, the radii are scaled to give the solid fraction to the last bit.
/// \param options with method, shape, seed, as_dense_as_possible and sides of the box; box.size and radii are set
/// \throws Error (bad_input), its place the name of the option, or empty: not two of the three, a periodic box or a
///         solid fraction for falling bodies, local_moves as dense as possible, a box without area, more than 1e7
///         bodies; as draw_radii
void set_amount(const PackingAmount& amount, const SizeDistribution& sizes, PackingOptions& options);

/// A packing with what its radii and box follow from.
struct ScalablePacking : PackingOptions {
  PackingAmount amount;
  SizeDistribution sizes;
};

/// A packing of another number of bodies, with radii drawn anew: the box keeps its shape, and the area for each body or
/// the solid fraction.
/// \throws Error (bad_input) as set_amount
ScalablePacking resized(ScalablePacking packing, std::int64_t grains, std::uint64_t seed);

}  // namespace equidem
