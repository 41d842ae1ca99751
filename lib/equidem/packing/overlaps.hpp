// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Discs that overlap push each other apart until nothing does, or nothing moves any more.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "equidem/grains/neighbours.hpp"
#include "equidem/packing/packing.hpp"

namespace equidem {

/// Two discs that overlap or may soon: i and the image of j at x_j + shift.
struct DiscPair {
  std::int32_t i = 0, j = 0;
  Vec2 shift;
};

/// Pairs i < j of discs with |x_j + shift - x_i| < r_i + r_j + margin, across the period of a periodic box too.
class PairFinder {
 public:
  const std::vector<DiscPair>& within(const PackingBox& box, std::span<const Vec2> centres,
                                      std::span<const double> radii, double margin);

 private:
  NeighbourFinder finder_;
  std::vector<Circle> circles_;
  std::vector<std::int32_t> owner_;
  std::vector<Vec2> shift_;
  std::vector<DiscPair> pairs_;
};

/// Unit springs between overlapping discs, and between discs and walls: energy sum overlap²/2 (- weight . x).
struct PushingOptions {
  double overlap = 1e-9;     ///< done where no overlap exceeds this, of the mean radius
  double unbalanced = 1e-7;  ///< or where the mean unbalanced force is this share of the mean contact force
  Vec2 weight = {};  ///< of a disc of the mean area, over unit stiffness times mean radius; in proportion to the area
  std::int64_t most = 20000;  ///< evaluations of all overlaps
};

struct PushingReport {
  bool apart = false;                            ///< no overlap beyond what is allowed
  bool balanced = false;                         ///< forces are
  double largest_overlap = 0, mean_overlap = 0;  ///< of those in contact, over the mean radius
  double unbalanced = 0;
  std::int64_t evaluations = 0;
};

/// Minimize the energy by FIRE (Bitzek et al. 2006, Phys. Rev. Lett. 97, 170201): motion with unit masses that is stopped where it goes
/// uphill, in steps that grow while it does not.
/// \param centres changed
PushingReport push_apart(const PackingBox& box, std::span<const double> radii, const PushingOptions& options,
                         PairFinder& finder, std::vector<Vec2>& centres);

}  // namespace equidem
