// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The rates of contacts on their limits: by Newton's method from the present statuses and, where it goes round in
/// circles, along a path from a state in which all of them stick.
///
/// Along that path every contact on a limit is pressed by a force tau w beside the law, w > 0, which loads balance:
/// where tau is large all stick, and tau = 0 is the rate problem. Between them the deformations D go along straight
/// pieces, one for each set of statuses; where a contact reaches the edge of its status it changes, and tau goes on as
/// before if the sign of the determinant of the tangent stays, else it turns (Katzenelson 1965, Bell Syst. Tech. J. 44,
/// 1605; Chien & Kuh 1976, IEEE Trans. Circuits Syst. 23, 305). Springs of `ground` at every component keep the path
/// from going to infinity at a finite tau, since no contact gives energy to a motion beyond that of its pressing: it
/// ends at tau = 0, or goes back to tau without end. Unlike Newton's method it does not go round in circles, and unlike
/// Lemke's pivots, whose slips to both sides of an open contact are a ray, it passes contacts that open.
#pragma once

#include <vector>

#include "equidem/breakage/unbonded/contact_rates.hpp"

namespace equidem {

struct RateSearch {
  RateAnswer answer;  ///< where none is found: of Newton's method, or of contacts that stick and do not hold the loads
  bool found = false;
};

/// Where contacts on limits do not balance the loads although all of them stick, no other statuses do: contacts that
/// slip and open exert no other directions of force.
/// \param solver with which the answer is made to balance without ground
/// \throws Error of kind interrupted where the user asked to stop
RateSearch search_rates(const RateProblem& problem, TangentSolver& solver, const std::vector<ContactStatus>& status);

}  // namespace equidem
