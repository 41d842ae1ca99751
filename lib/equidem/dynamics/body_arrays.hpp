// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Motions and velocities of discs in the layout of the loop.
#pragma once

#include <vector>

#include "equidem/contact/frame.hpp"
#include "equidem/dynamics/kernels/step_kernel.hpp"
#include "equidem/dynamics/layout.hpp"
#include "equidem/motion/lane_vector.hpp"

namespace equidem {

/// Arrays by place, with conversion from and to discs.
class BodyArrays {
 public:
  /// All discs at rest in the reference position.
  BodyArrays(DiscLayout layout, const LoopKind& kind);

  LaneVector<double> motion[2];       ///< places x width
  LaneVector<double> velocity;        ///< groups x unknowns x lanes
  LaneVector<double> velocity_at[2];  ///< dashpots only: places x width
  LaneVector<double> dashpot;         ///< dashpots only: groups x unknowns x lanes

  [[nodiscard]] const DiscLayout& layout() const { return layout_; }
  [[nodiscard]] std::vector<DiscMotion> discs_of(const LaneVector<double>& motions) const;
  void put(const std::vector<DiscMotion>& discs, LaneVector<double>& motions) const;
  [[nodiscard]] std::vector<DiscMotion> disc_velocities(const LaneVector<double>& velocities) const;
  /// Set `velocity` and, with dashpots, both `velocity_at`.
  void put_velocities(const std::vector<DiscMotion>& discs);
  /// Set the pointers of a loop to these arrays.
  void connect(LoopData& data);

 private:
  DiscLayout layout_;
  int unknowns_, width_;
};

}  // namespace equidem
