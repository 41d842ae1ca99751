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
};

/// Measured in some 30 ms, with the number of threads set to 1 meanwhile: the solution of a block of 1700 discs, and a
/// product of dense matrices.
SolveRates measure_solve_rates();

/// s a disc on one thread of a solution by multigrid with the bound of its error, of which the set-up of the grids is a
/// third. Measured in some 0.1 s.
double measure_multigrid_rate();

/// s of the set-up and of the solution of a number of load cases with the bounds of their errors, each with a set-up of
/// its own where the method is elimination; mostly within a factor of two. Measures the rates of this machine.
double estimate_seconds(const SolveEstimate& estimate, double solutions, int threads);

}  // namespace equidem
