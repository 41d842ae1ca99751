// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Unbalanced forces, which vanish at rest.
#pragma once

#include <span>

#include "equidem/grains/grain_simulation.hpp"

namespace equidem {

/// Unbalanced forces of bodies over the mean contact force; infinite without contacts.
struct Unbalance {
  double mean = 0, largest = 0;
};

/// Unbalanced forces: contact forces plus weights. Bonded grains are one body.
Unbalance unbalance_of(std::span<const Grain> grains, std::span<const GrainContact> contacts,
                       std::span<const GrainBond> bonds, Vec2 gravity);

}  // namespace equidem
