// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Forces of contacts that follow motions, and the load factors at which they break.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "equidem/core/vector.hpp"
#include "equidem/material/spring_constants.hpp"
#include "equidem/statics/breaking/least_load_factor.hpp"

namespace equidem {

/// A contact as its forces are evaluated. Discs are named by their position in the order of elimination.
struct BreakingContact {
  std::int32_t i = 0, j = 0;
  Vec2 normal;
  double lever_i = 0, lever_j = 0;  ///< m; 0 where rotations are no unknowns
  SpringConstants springs;
  ContactStrength strength;
};

/// Offsets of a contact point from the line of centres (ContactArms), m.
struct ContactOffsets {
  double i = 0, j = 0;
};

/// How the motions of discs are given: `block` components of each, m, rotations times `rotation_scale`, m.
struct MotionLayout {
  int block = 3;
  double rotation_scale = 1;
};

/// Stretch and slip by the motions of its discs.
ContactDeformation opening_of(const BreakingContact& contact, const ContactOffsets& offsets, const MotionLayout& layout,
                              const double* motion);

/// Add to the forces of contacts what motions of their discs do. \param offsets one for each contact; empty: 0
void add_forces(std::span<const BreakingContact> contacts, std::span<const ContactOffsets> offsets,
                const MotionLayout& layout, const double* motion, std::span<ContactForce> forces);

constexpr std::uint8_t never_breaks = 255;  ///< in place of the rate_class of a contact

/// The least load factor in a direction of lambda, to round-off, and the largest utilization under the dead load; 0 and
/// infinite where a contact has no strength. \param dead forces, empty where there are none
/// \param classes rate_class of each contact
ClassedUtilization utilization_of(std::span<const BreakingContact> contacts, std::span<const ContactForce> live,
                                  std::span<const ContactForce> dead, std::span<const std::uint8_t> classes,
                                  double friction, double direction);

}  // namespace equidem
