// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Forces of contacts by motions of two doubles a component: differences of a motion of 1000 stretches carry the
/// round-off of 1000 stretches, and forces of one double with them.
#pragma once

#include <cstddef>
#include <span>

#include "equidem/statics/breaking/kernels/breaking_contacts.hpp"

namespace equidem {

/// A motion as an unevaluated sum of two doubles for each component (PreciseMotion).
struct PreciseColumn {
  const double* high = nullptr;
  const double* low = nullptr;  ///< null: 0
};

/// The part of a force beyond double precision, N/m.
struct ForceRemainder {
  float normal = 0, tangential = 0;
};

/// Stretch and slip of a contact, m.
ContactDeformation opening_of(const BreakingContact& contact, const ContactOffsets& offsets, const MotionLayout& layout,
                              const PreciseColumn& motion);

/// Forces of contacts. \param offsets one for each contact; empty: 0 \param affine deformations by a mean strain, one
/// for each contact, m; empty: none
void evaluate_forces(std::span<const BreakingContact> contacts, std::span<const ContactOffsets> offsets,
                     const MotionLayout& layout, const PreciseColumn& motion,
                     std::span<const ContactDeformation> affine, std::span<ContactForce> forces,
                     std::span<ForceRemainder> remainders);

}  // namespace equidem
