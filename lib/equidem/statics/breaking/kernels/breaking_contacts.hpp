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

/// A contact with what its forces follow from. Discs are named by their position in the order of elimination.
struct BreakingContact {
  std::int32_t i = 0, j = 0;
  Vec2 normal;
  /// Levers and offsets over the length a by which rotations are scaled; 0 where rotations are no unknowns.
  double turn_i = 0, turn_j = 0, open_i = 0, open_j = 0;
  SpringConstants springs;
  ContactStrength strength;
  ProportionalForce force;
};

/// Stretch and slip by the motions of its discs. \param motion per component, `block` of a disc, m
ContactDeformation opening_of(const BreakingContact& contact, int block, const double* motion);

/// Add to the forces of contacts what motions of their discs do. \param live of the load that grows, `dead` of the
/// other one, null where there is none: per component, `block` of a disc, m
void add_forces(std::span<BreakingContact> contacts, int block, const double* live, const double* dead);

constexpr std::uint8_t never_breaks = 255;  ///< in place of the rate_class of a contact

/// The least load factor in a direction of lambda, to round-off, and the largest utilization under the dead load; 0 and
/// infinite where a contact has no strength. \param classes rate_class of each contact
ClassedUtilization utilization_of(std::span<const BreakingContact> contacts, std::span<const std::uint8_t> classes,
                                  double friction, double direction);

}  // namespace equidem
