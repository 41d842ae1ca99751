// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Derivatives of what follows from the stiffness matrix by springs, loads and places, without another factorization.
///
/// The form a . K b of two motions, with the deformations D a, D b of contacts and their springs k, changes by
///
///   d(a . K b) = sum_c dk (D a)(D b) + k (dD a)(D b) + k (D a)(dD b).
///
/// A natural frequency of the mode a, which is unique and has the modal mass 1, changes by d(omega²) = d(a . K a).
///
/// A number q that is a weighted sum of the motions u of an equilibrium (weights g) and of the forces of contacts
/// (weights w) changes with the springs, the loads f and the geometry by
///
///   dq = lambda . df - sum_c [dk (D lambda - w)(D u) + k (dD lambda)(D u) + k (D lambda - w)(dD u)],
///
/// where K lambda = g + D^T k w: lambda is the state under the weights as loads, with supports that stay.
#pragma once

#include <span>
#include <vector>

#include "equidem/statics/equilibrium.hpp"

namespace equidem {

/// Derivatives of a number by the springs of each contact, in its unit over that of the spring; empty where it has
/// none.
struct SpringDerivatives {
  std::vector<double> by_kN, by_kT;  ///< per contact, by Pa
  std::vector<double> by_kM;         ///< per contact, by N; empty where contacts do not bend

  /// The change where the springs of a contact grow by a common factor, over its change.
  [[nodiscard]] double change_by(const ContactSprings& springs, std::size_t contact) const;
  /// Standard deviation over the coefficient of variation of the springs, to first order, where those of each contact
  /// (kN, kT and kM by one factor) scatter independently.
  [[nodiscard]] double scatter(const ContactSprings& springs) const;
};

struct SpringAndPlaceDerivatives : SpringDerivatives {
  /// Per disc, by m, while levers keep their shares of the distance, springs and contacts what they are; empty where
  /// contact points are off the line of centres, or forces at rest count.
  std::vector<Vec2> by_position;
};

/// Differentiates a . K b, N. Supports are no part of K: components that they hold are those of the motions given.
/// \param a, b one motion for each disc, m and rad; rotations count where kT or kM resists them
/// \throws Error (bad_input) where they are motions of another number of discs
SpringAndPlaceDerivatives form_derivatives(const Assembly& assembly, const ContactSprings& springs,
                                           std::span<const DiscMotion> a, std::span<const DiscMotion> b);

/// The weights of a measured number; those of held components and of rotations that are no unknowns do not count.
struct Measure {
  std::vector<DiscForce> motions;    ///< per disc: dq/du and dq/dtheta; empty: none
  std::vector<ContactForce> forces;  ///< per contact: dq/dN and dq/dT; empty: none
};

/// Derivatives of q; those by places leave loads and weights what they are.
struct MeasureDerivatives : SpringAndPlaceDerivatives {
  double value = 0;                 ///< q
  std::vector<DiscMotion> by_load;  ///< per disc, by N/m of force and N of moment
};

/// Solves once more with the factor of the solver, for the weights as loads.
/// What supports prescribe stays, and is no parameter.
/// \param state of this solver, under the loads at which q is measured
/// \throws Error (bad_input) where the weights are of another number of discs or contacts, or do work on a mechanism
///         that is held, so that q is not determined; as EquilibriumSolver::solve
MeasureDerivatives derivatives(EquilibriumSolver& solver, const Equilibrium& state, const Measure& measure);

}  // namespace equidem
