// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Solving a stiffness matrix by conjugate gradients with a multigrid cycle: work and memory grow as the number of
/// discs.
#pragma once

#include <memory>

#include "equidem/linear/contact_graph.hpp"
#include "equidem/linear/factorization.hpp"
#include "equidem/linear/linear_solver.hpp"
#include "equidem/linear/multigrid/cycle.hpp"

namespace equidem {

/// Each solve brings the residual down to 3e-7 of what it was; refinement brings the rest. Everything that is given
/// must outlive the result, whose solve one thread may call at a time.
/// \throws Error (computation_failed), with the method that serves, where the network is not known to be rigid
///         (grows_rigid) and iterations on a rough load, or later those of a solve, do not converge or meet a motion
///         without stiffness
std::unique_ptr<Factorization> multigrid_solver(const SpringNetwork& network,
                                                const multigrid::CycleOptions& options = {},
                                                int max_iterations = most_iterations);

/// Estimate of the bytes that it takes beside the assembly.
double bytes_of_multigrid(double discs, double contacts);

}  // namespace equidem
