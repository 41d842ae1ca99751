// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Unbalanced forces and moments, which vanish at rest.
#pragma once

#include <span>

#include "equidem/grains/grain_simulation.hpp"

namespace equidem {

/// Unbalanced loads of bodies over the mean contact force: sqrt(F² + (M/R)²), M the moment about the centre of mass, R
/// the radius of the circle about it that holds the body. Infinite without contacts.
struct Unbalance {
  double mean = 0, largest = 0;
};

/// Unbalanced loads: forces and moments of contacts and of bonds with springs, plus weights. Grains that are tied by
/// dashpots alone, which creep under any force, are one body. \param bonds of the simulation that have not broken, in
/// any order
Unbalance unbalance_of(const GrainSimulation& simulation, std::span<const GrainBond> bonds, Vec2 gravity);

}  // namespace equidem
