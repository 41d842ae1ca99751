// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// How dense a packing is, and how its discs touch.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "equidem/packing/packing.hpp"

namespace equidem {

/// A rectangle, m.
struct Region {
  Vec2 low, high;
  [[nodiscard]] double area() const { return (high.x - low.x) * (high.y - low.y); }
};

/// The area that a disc and a rectangle share, exactly, m².
double clipped_area(Vec2 centre, double radius, const Region& region);

/// Two discs that touch, or a disc and a wall.
struct PackingContact {
  std::int32_t i = 0;
  std::int32_t j = 0;                     ///< ~j a wall, where negative: 0 floor, 1 left, 2 right, 3 lid
  std::int32_t shift_x = 0, shift_y = 0;  ///< i touches j at x_j + (shift_x Lx, shift_y Ly)
  double overlap = 0;                     ///< m
};

/// All that overlap or whose gap is at most 1e-8 of the smaller radius; i < j, ordered.
std::vector<PackingContact> contacts_of(const DiscPacking& packing);

struct PackingMeasures {
  Region region;  ///< in which the next three are measured
  double solid_fraction = 0;
  double void_ratio = 0;  ///< e = n/(1 - n)
  double porosity = 0;    ///< n = 1 - solid fraction
  std::int64_t contacts = 0, wall_contacts = 0;
  double coordination = 0;                   ///< contacts of a disc, those with walls included
  double coordination_without_rattlers = 0;  ///< the same of the rest
  std::int64_t rattlers = 0;                 ///< discs with too few contacts to be held, one after the other
  double largest_overlap = 0;                ///< over the smaller radius
};

/// The box without strips of two mean diameters at its walls; under an open top also without three below the lowest place of the surface,
/// seen in columns two largest diameters wide. The whole box where it is periodic, or too small for that.
Region measured_region(const DiscPacking& packing);

/// \param region none: measured_region
/// \throws Error (bad_input) on a region without area
PackingMeasures measure(const DiscPacking& packing, std::optional<Region> region = {});

}  // namespace equidem
