// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Choice of the linear solver.
#pragma once

#include <cstdint>
#include <string>

namespace equidem {

/// The back ends.
enum class SolverMethod {
  automatic,     ///< multifrontal: Cholesky where no spring is negative, else L D L^T
  multifrontal,  ///< ours: geometric nested dissection on the graph of discs, threads over subtrees
  cholmod,       ///< SuiteSparse's supernodal Cholesky with our ordering
  umfpack,       ///< SuiteSparse's unsymmetric LU with partial pivoting, ordered by itself
};

/// \throws Error (bad_input) naming the choices
SolverMethod solver_method_from(const std::string& name);
std::string to_string(SolverMethod method);

struct SolverOptions {
  SolverMethod method = SolverMethod::automatic;
  int max_refinements = 4;  ///< steps of iterative refinement, >= 0
  double memory_limit = 0;  ///< bytes that factor and factorization may take; 0: what the machine has free
};

/// \throws Error (bad_input) on a negative number of refinements or a memory limit that is negative or no number
void check(const SolverOptions& options);

/// What a factorization will take, known before it is tried.
struct SolveEstimate {
  std::int64_t unknowns = 0;
  double factor_nonzeros = 0;  ///< entries of L
  double factor_bytes = 0;
  double peak_bytes = 0;  ///< factor and what lives beside it during factorization
  double operations = 0;  ///< additions and multiplications
};

}  // namespace equidem
