// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Prediction of the time of a solution.
#pragma once

#include "equidem/linear/linear_solver.hpp"

namespace equidem {

/// Rates of this machine on one thread.
struct SolveRates {
  double per_entry = 0;      ///< s an entry of the factor: ordering, assembly, memory, solution, refinement
  double per_operation = 0;  ///< s a multiplication or addition of the factorization
  double per_disc = 0;       ///< s of a solution by multigrid with the bound of its error, a third of it for the grids
};

/// Those of the method (multigrid, or multifrontal for all others), measured with the number of threads set to 1
/// meanwhile: in some 30 ms by the solution of a block of 1700 discs and a product of dense matrices, or in some 0.1 s
/// by the solution of a block of 8100 discs.
SolveRates measure_solve_rates(SolverMethod method);

/// s of the solution of a number of load cases with the bounds of their errors, with one set-up of grids for all but a
/// factorization for each; mostly within a factor of two.
double estimate_seconds(const SolveEstimate& estimate, double solutions, const SolveRates& rates, int threads);

}  // namespace equidem
