// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Density and contacts of a packing.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "equidem/assembly/touching.hpp"
#include "equidem/fields/box_measures.hpp"
#include "equidem/packing/packing.hpp"

namespace equidem {

/// Two grains that touch, or a grain and a wall; clumps may do so in several places.
struct PackingContact {
  std::int32_t i = 0;
  std::int32_t j = 0;                     ///< ~j a wall, where negative: 0 floor, 1 left, 2 right, 3 lid
  std::int32_t shift_x = 0, shift_y = 0;  ///< i touches j at x_j + (shift_x Lx, shift_y Ly)
  double overlap = 0;                     ///< m
  Vec2 normal;                            ///< unit, from i to j
  /// From the centre of grain i to the contact point, m: between the surfaces in proportion to the radii of the parts
  /// that touch, on the wall.
  Vec2 arm_i;
  /// Curvatures of both surfaces, 1/m, about their centres as seen from the contact point; of a wall 0.
  double curvature_i = 0, curvature_j = 0;
};

/// All pairs that overlap, or whose gap is at most `gap_tolerance` times the sum of the radii of the two bodies, of the
/// body where the other is a wall; 0: at most 1e-8 of the smaller radius; i < j, ordered. The grains of a bonded pair
/// do not touch each other.
std::vector<PackingContact> contacts_of(const GrainPacking& packing, double gap_tolerance = 0);

/// Contacts between bodies that gap tolerances would find (assembly/touching.hpp).
std::vector<BondCount> bond_counts(const GrainPacking& packing);

/// 1 for the bodies that are left out where those with fewer than `needed` contacts are removed, one after another.
/// \param partners of each body, one for each contact; negative: a wall
std::vector<char> rattlers_of(const std::vector<std::vector<std::int32_t>>& partners, std::size_t needed);

struct PackingMeasures : SolidMeasures {
  Rectangle region;  ///< in which solids are measured
  std::int64_t contacts = 0, wall_contacts = 0;
  double coordination = 0;                   ///< contacts of a body, those with walls included
  double coordination_without_rattlers = 0;  ///< the same of the rest
  std::int64_t rattlers =
      0;  ///< bodies with fewer than three contacts, under their weight two: not held, one after the other
  double largest_overlap = 0;  ///< over the smaller radius (of the body: PackingShape)
};

/// As that of a box in a run (fields/box_measures.hpp); the whole box where it is periodic, or too small for that.
Rectangle measured_region(const GrainPacking& packing);

/// \throws Error (bad_input) on a region without area, or out of a periodic box
void check_region(const PackingBox& box, const Rectangle& region);

/// \param region none: measured_region
/// \throws Error (bad_input) on a region without area, without any body, or out of a periodic box
PackingMeasures measure(const GrainPacking& packing, std::optional<Rectangle> region = {});

}  // namespace equidem
