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
  const int springs = kind.equal_contacts ? 3 : kind.motion == LoopKind::Motion::finite ? 7 : 6;
  return springs + (kind.resistance == LoopKind::Resistance::dashpot && !kind.equal_contacts ? 2 : 0);
}

}  // namespace lanes

/// Write the contact of one lane into its slot, in the order that LoopData::geometry states; c_N and c_T are not
/// changed. A lane of zeros means no contact. \param branch from the disc of this lane to its neighbour, at rest, m
/// \param lever_own, lever_other of the disc and of its neighbour, m
/// \param k of this contact, Pa; equal contacts use those of LoopData
/// \param slot slot_doubles(kind) x 4 doubles
/// \param lane 0 .. 3
void fill_geometry(const LoopKind& kind, Vec2 branch, double lever_own, double lever_other, SpringConstants k,
                   double* slot, int lane);

}  // namespace equidem
