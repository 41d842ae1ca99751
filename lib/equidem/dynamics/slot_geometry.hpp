// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Contact data in a slot of the loop.
#pragma once

#include "equidem/core/vector.hpp"
#include "equidem/dynamics/kernels/step_kernel.hpp"
#include "equidem/material/spring_constants.hpp"

namespace equidem {

namespace lanes {

/// Doubles of one slot and lane: LoopData::geometry.
constexpr int slot_doubles(const LoopKind& kind) {
  const int springs = kind.equal_contacts ? 3 : kind.motion == LoopKind::Motion::finite ? 7 : 6, bending = kind.bending;
  const bool dashpots = kind.resistance == LoopKind::Resistance::dashpot && !kind.equal_contacts;
  return springs + bending + (dashpots ? 2 + bending : 0);
}

}  // namespace lanes

/// Write the contact of one lane into its slot, in the order that LoopData::geometry states; constants of
/// dashpots are not changed. A lane of zeros means no contact. \param branch from the disc of this lane to its
/// neighbour, at rest, m \param lever_own, lever_other of the disc and of its neighbour, m
/// \param k of this contact, Pa; equal contacts use those of LoopData
/// \param kM of this contact, N, where kind.bending
/// \param slot slot_doubles(kind) x 4 doubles
/// \param lane 0 .. 3
void fill_geometry(const LoopKind& kind, Vec2 branch, double lever_own, double lever_other, SpringConstants k,
                   double kM, double* slot, int lane);

}  // namespace equidem
