// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Bodies that overlap push each other apart until nothing does, or nothing moves any more.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "equidem/geometry/neighbours.hpp"
#include "equidem/packing/packing.hpp"

namespace equidem {

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
