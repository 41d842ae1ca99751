// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Density and contacts of a packing, the forces that they carry at rest, and the packing as a network of contacts with
/// springs: what statics takes.
///
/// Bodies of a network are those of the packing, numbered alike. Discs touch on the lines of their centres, with levers
/// in proportion to the radii. Of ellipses and clumps each contact has its normal and its point (ContactArms), each
/// body its section (BodySection) and the radius of the disc of equal area; clumps may touch in several places, with a
/// spring in each. A pair tied by dashpots counts as one rigid body: at rest dashpots resist nothing, and without them
/// the pair would fall apart, while over any time in which bodies move little they hold it. Springs are those given;
/// the forces at rest, where the packing carries some, go with the contacts.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/assembly/touching.hpp"
#include "equidem/contact/frame.hpp"
#include "equidem/fields/box_measures.hpp"
#include "equidem/material/spring_relations.hpp"
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

struct PackingMeasures : SolidMeasures {
  Rectangle region;  ///< in which solids are measured
  std::int64_t contacts = 0, wall_contacts = 0;
  double coordination = 0;                   ///< contacts of a body, those with walls included
  double coordination_without_rattlers = 0;  ///< the same of the rest
  /// Bodies with fewer than three contacts, under their weight two: not held, one after the other.
  std::int64_t rattlers = 0;
  double largest_overlap = 0;  ///< over the smaller radius (of the body: PackingShape)
};

/// As that of a box in a run (fields/box_measures.hpp); the whole box where it is periodic, or too small for that.
Rectangle measured_region(const GrainPacking& packing);

/// \throws Error (bad_input) on a region without area, or out of a periodic box
void check_region(const PackingBox& box, const Rectangle& region);

/// \param region none: measured_region
/// \throws Error (bad_input) on a region without area, without any body, or out of a periodic box
PackingMeasures measure(const GrainPacking& packing, std::optional<Rectangle> region = {});

struct NetworkOptions {
  std::optional<SpringConstants> springs = {};  ///< of every contact; none: left to the user of the network
  double gap_tolerance = 0;                     ///< of contacts_of
};

/// The bodies and the contacts between them.
Assembly network_of(const GrainPacking& packing, const NetworkOptions& options);

/// The network with walls as supports.
struct HeldNetwork {
  /// Contacts with a wall are ones with a body that mirrors it behind the wall; these are the group "walls": held, they
  /// resist as the wall does. Bodies with fewer than two contacts, which could roll, are left out one after the other.
  Assembly assembly;
  std::vector<std::int32_t> bodies;  ///< of the packing: the first of the assembly
};
HeldNetwork held_network_of(const GrainPacking& packing, const NetworkOptions& options);

}  // namespace equidem
