// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Time that each law needs for the same accuracy.
///
/// The dimensionless stiffness is kept as the step falls, as in Fujioka & Ushijima (2005), so that all laws tend to
/// rigid bodies and impacts without duration. For these the exact motion is known: a bouncing ball in closed form, the
/// stacked spheres by eq. (28), a gas of discs from impact to impact.
#pragma once

#include <span>
#include <string>

#include "equidem/grains/grain_simulation.hpp"

namespace equidem::bench {

/// A law with its settings.
struct Variant {
  std::string name;
  NormalLaw law = NormalLaw::linear_dashpot;
  double dimensionless = 0;  ///< a = k dt²/m
  GrainOptions::Integrator integrator = GrainOptions::Integrator::semi_implicit_euler;
};
PairProperties pair_of(const Variant& variant, double restitution);
GrainSimulation start(const GrainScene& scene, const Variant& variant, double step);

/// A table for each scene, times compared with those of the first variant.
/// \param halvings of the coarsest step
std::string compare_accuracy(std::span<const Variant> variants, int halvings);

}  // namespace equidem::bench
