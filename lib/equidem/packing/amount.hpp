// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Amount to pack: box and radii from two of number, box and solid fraction.
#pragma once

#include <cstdint>
#include <optional>

#include "equidem/packing/packing.hpp"
#include "equidem/packing/size_distribution.hpp"

namespace equidem {

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
