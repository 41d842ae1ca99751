// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A proof that the rate problem of contacts on their limits has one answer, by matrices of the size of those contacts:
/// where it succeeds, no combination of statuses has to be tried.
///
/// With the openings and slips e of the contacts on limits, the forces there are f = f_0 - S e. S is the Schur
/// complement of the network in which all of them stick, symmetric and at least semidefinite:
///
///   S = B - B C_s B,   B = diag(kN, kT),   C_s = G K_s^-1 G^T.
///
/// The differences D of two answers satisfy Da DN >= 0 where a contact may open, and Dp DT + mu theta Dp DN >= 0 where
/// it may slip: theta is the direction of the friction, and somewhere in [-1, 1] where neither force is left. The sum
/// over contacts is
///
///   -De^T (S + mu P_theta^T S) De >= 0,
///
/// so that De = 0 where the symmetric part of S + mu P_theta^T S is positive definite for every theta. The unknown
/// theta are replaced by 2 |x y| <= alpha x² + y²/alpha, alpha = sqrt(S_nn S_tt). For mu = 0 the condition is S > 0.
#pragma once

#include <span>

#include "equidem/breakage/unbonded/contact_rates.hpp"

namespace equidem {

/// \param solver with the tangents of `status`
/// \param status per contact
/// \return true: the rates of every load are unique; false: nothing is proved
bool proved_unique(const RateProblem& problem, const TangentSolver& solver, std::span<const ContactStatus> status);

}  // namespace equidem
