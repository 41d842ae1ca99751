// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Rates of contacts on their limits, followed from a state in which all of them stick.
///
/// Every contact on a limit is pressed by a force tau w beside the law, w > 0, which loads balance: where tau is large
/// all stick, and tau = 0 is the rate problem. Between them the deformations D go along straight pieces, one for each
/// set of statuses; where a contact reaches the edge of its status it changes, and tau goes on as before if the sign
/// of the determinant of the tangent stays, else it turns (Katzenelson 1965, Bell Syst. Tech. J. 44, 1605; Chien & Kuh
/// 1976, IEEE Trans. Circuits Syst. 23, 305). Springs of `ground` at every component keep the path from going to
/// infinity at a finite tau, since no contact gives energy to a motion beyond that of its pressing: it ends at tau = 0,
/// or goes back to tau without end. Unlike Newton's method it does not go round in circles, and unlike Lemke's pivots,
/// whose slips to both sides of an open contact are a ray, it passes contacts that open.
#pragma once

#include <optional>
#include <vector>

#include "equidem/breakage/unbonded/contact_rates.hpp"

namespace equidem {

/// \param solver with which the answer is made to balance without ground
/// \return none where no path ends at an answer that agrees with its rates and balances the loads
std::optional<RateAnswer> follow_rates(const RateProblem& problem, TangentSolver& solver,
                                       std::vector<ContactStatus> status);

/// The motion at the end of that path with the springs of `ground`, per component; empty: the path goes back.
/// \param problem by no prescribed motion of loads
/// \param ground over the stiffest spring
std::vector<double> motion_on_ground(const RateProblem& problem, const std::vector<ContactStatus>& status,
                                     double ground);

}  // namespace equidem
