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

/// s of one factorization and the solution of one load case with the bound of its error; mostly within a factor of two.
double estimate_seconds(const SolveEstimate& estimate, const SolveRates& rates, int threads);

}  // namespace equidem
