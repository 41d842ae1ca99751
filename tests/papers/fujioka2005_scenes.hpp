// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Scenes of Fujioka & Ushijima (2005), "An evaluation method of normal contact force with energy conservation in
/// distinct element method", section 5.
#pragma once

#include <optional>

#include "equidem/grains/grain_simulation.hpp"

namespace equidem::fujioka2005 {

// Section 5.1.
constexpr double restitution = 0.7;
constexpr double gravity = 9.8;          ///< m/s²
constexpr double diameter = 225;         ///< m
constexpr double drop = 0.01;            ///< height of the fall, in diameters
constexpr double stacked_radius = 0.02;  ///< m, section 5.6

/// Dimensionless stiffness k dt²/m, for hertz_dashpot k d_c^(1/2) dt²/m. The paper does not print it; it follows from
/// the counts of Table 2 and is kept while the step changes.
constexpr double stiffness_of(NormalLaw law) {
  return law == NormalLaw::hertz_dashpot ? 4.62 : 0.10;
}

/// Contacts end at zero overlap as in the paper, those of exact_flow where the force is zero.
/// \param a dimensionless stiffness; empty: stiffness_of(law)
PairProperties pair_of(NormalLaw law, double e = restitution, std::optional<double> a = {});

/// Spheres in a vertical column over a floor at y = 0, the k-th lowest with k + 1 gaps below it.
/// \param gap in diameters
/// \param size diameter, m
GrainScene column(const PairProperties& pair, int balls, double gap = drop, double size = diameter);

/// The three spheres of Fig. 9: A and B on the floor, C on top of them.
GrainScene stacked(const PairProperties& pair);

// Exact values of section 5.6.
constexpr double exact_speed = 0.271462651012440;   ///< d', eq. (28)
constexpr double exact_parting = 0.10673687246956;  ///< T0, s, eq. (30); the sum (31) omits the singular end
GrainSimulation start(const GrainScene& scene, NormalLaw law, double step, bool refuse_crossing = true);

}  // namespace equidem::fujioka2005
