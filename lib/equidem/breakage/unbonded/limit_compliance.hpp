// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The network as the contacts on limits feel it: C = G K^-1 G^T.
#pragma once

#include <vector>

#include "equidem/breakage/unbonded/contact_rates.hpp"

namespace equidem {

/// Their deformations, row by row, by unit pairs of forces at them, 2 rows and columns a contact: stretch and slip.
/// Where the driving prescribes a motion it is kept. \param solver with the tangents that C is wanted for
std::vector<double> limit_compliance(const RateProblem& problem, const TangentSolver& solver);

}  // namespace equidem
