// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Bodies that overlap push each other apart until nothing does, or nothing moves any more.
///
/// Exact contacts of two bodies, or of a body and a side of the box; clumps may have several.
#pragma once

#include <array>
#include <cstdint>

#include "equidem/geometry/neighbours.hpp"
#include "equidem/geometry/shape_contact.hpp"
#include "equidem/grains/scene/grain_shapes.hpp"
#include "equidem/packing/packing.hpp"
#include "equidem/packing/packing_shape.hpp"

namespace equidem {

/// 0 floor, 1 left, 2 right, 3 lid: as many as the box has.
inline std::array<HalfPlane, 4> sides_of(const PackingBox& box) {
  return {HalfPlane{{0, 1}, 0}, HalfPlane{{1, 0}, 0}, HalfPlane{{-1, 0}, box.size.x}, HalfPlane{{0, -1}, box.size.y}};
}
inline std::size_t count_of_sides(const PackingBox& box) {
  return box.periodic() ? 0 : box.sides == PackingBox::Sides::open_top ? 3 : 4;
}

/// Call visitor(side, touch) for all contacts with the sides of the box whose gap is smaller than `gap`.
template <typename Visitor>
void for_wall_touches(const Outline& i, Vec2 place, const PackingBox& box, double gap, const Visitor& visitor) {
  const auto sides = sides_of(box);
  for (std::size_t w = 0; w < count_of_sides(box); ++w)
    for_touches(i, place, sides[w], gap, [&](const Touch& touch) { visitor(static_cast<int>(w), touch); });
}

/// Unit springs between overlapping bodies, and between bodies and walls: energy sum overlap²/2 (- weight . x).
struct PushingOptions {
  double overlap = 1e-9;     ///< done where no overlap exceeds this, of the mean radius
  double unbalanced = 1e-7;  ///< or where the mean unbalanced force is this share of the mean contact force
  Vec2 weight = {};  ///< of a body of the mean area, over unit stiffness times mean radius; in proportion to the area
  std::int64_t most = 20000;  ///< evaluations of all overlaps
};

struct PushingReport {
  bool apart = false;                            ///< no overlap beyond what is allowed
  bool balanced = false;                         ///< forces are
  double largest_overlap = 0, mean_overlap = 0;  ///< of those in contact, over the mean radius
  double unbalanced = 0;  ///< of forces and of moments over the longest lever of a body (UnitBody::lever)
  std::int64_t evaluations = 0;
};

/// Minimize the energy by FIRE (Bitzek et al. 2006, Phys. Rev. Lett. 97, 170201): motion with unit masses that is
/// stopped where it goes uphill, in steps that grow while it does not. Bodies turn by an angle whose arc at their
/// longest lever counts as their motion. \param bodies moved and turned
PushingReport push_apart(const PackingBox& box, const UnitBody& shape, const PushingOptions& options,
                         PairFinder& finder, Bodies& bodies);

}  // namespace equidem
