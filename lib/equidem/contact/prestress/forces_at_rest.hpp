// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The forces that the contacts of an assembly carry at rest, before any motion (Assembly::contact_normal_force).
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/contact/frame.hpp"

namespace equidem {

/// True where some contact carries a force at rest.
bool carries_forces(const Assembly& assembly);

/// The force at rest of a contact; 0 where the assembly has none.
inline ContactForce force_at_rest(const Assembly& assembly, std::size_t contact) {
  if (assembly.contact_normal_force.empty()) return {};
  return {assembly.contact_normal_force[contact], assembly.contact_tangential_force[contact]};
}

/// The forces at rest that act on every body together, N/m, and their moments about its centre, N.
struct RestSums {
  std::vector<Vec2> forces;
  std::vector<double> moments;
  std::int64_t loaded = 0;  ///< contacts that carry a force, beyond round-off of the largest
  double mean_force = 0;    ///< N/m, magnitude, over those contacts
};
RestSums sums_at_rest(const Assembly& assembly);

/// The sums of the forces at rest on every body, which vanish where these forces balance each other. Weight and other
/// loads are not counted: the part that they balance is told here as lacking.
struct RestBalance {
  std::int64_t loaded = 0;         ///< likewise
  double mean_force = 0;           ///< N/m, magnitude, over those contacts
  double largest_force = 0;        ///< N/m, the largest sum of forces on one body
  double largest_moment = 0;       ///< N, the largest sum of moments on one body, about its centre
  std::int32_t disc_of_force = 0;  ///< the first body with that force
  std::int32_t disc_of_moment = 0;
  double relative = 0;  ///< the larger of force and moment over the mean radius, over the mean force; 0 without forces
};

/// \param held discs that are not counted, since supports balance them; ascending
RestBalance balance_at_rest(const Assembly& assembly, const std::vector<std::int32_t>& held = {});

}  // namespace equidem
