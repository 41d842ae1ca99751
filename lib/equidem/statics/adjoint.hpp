// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Derivatives of what is measured of an equilibrium, all of them by one more solution with the factor that exists.
///
/// A number q that is a weighted sum of motions u (weights g) and of deformations D u of contacts times their springs k
/// (weights w of the forces) changes with the springs, the loads f and the geometry by
///
///   dq = lambda . df - sum_c [dk (D lambda - w)(D u) + k (dD lambda)(D u) + k (D lambda - w)(dD u)],
///
/// where K lambda = g + D^T k w: lambda is the state under the weights as loads, with supports that stay.
#pragma once

#include <vector>

#include "equidem/statics/equilibrium.hpp"

namespace equidem {

/// The weights of a measured number; those of held components and of rotations that are no unknowns do not count.
struct Measure {
  std::vector<DiscForce> motions;    ///< per disc: dq/du and dq/dtheta; empty: none
  std::vector<ContactForce> forces;  ///< per contact: dq/dN and dq/dT; empty: none
};

/// Derivatives of q, in its unit over that of the parameter.
struct MeasureDerivatives {
  double value = 0;                  ///< q
  std::vector<double> by_kN, by_kT;  ///< per contact, by Pa
  std::vector<double> by_kM;         ///< per contact, by N; empty where contacts do not bend
  std::vector<DiscMotion> by_load;   ///< per disc, by N/m of force and N of moment
  /// Per disc, by m, while levers keep their shares of the distance, loads and weights what they are; empty where
  /// contact points are off the line of centres, or forces at rest count.
  std::vector<Vec2> by_position;
};

/// \param state of this solver
/// \throws Error (bad_input) where the weights are of another number of discs or contacts; as EquilibriumSolver::solve
MeasureDerivatives derivatives(EquilibriumSolver& solver, const Equilibrium& state, const Measure& measure);

}  // namespace equidem
