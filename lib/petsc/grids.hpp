// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The multigrid of equidem over the ranks, as a preconditioner of PETSc.
#pragma once

#include <petscksp.h>

#include "petsc/network.hpp"

namespace equidem::petsc {

/// The name of the preconditioner: -equidem_pc_type equidem.
inline constexpr const char* grids_type = "equidem";

/// Makes the name known to PETSc. Calls after the first one have no effect.
void register_grids();

/// Whether the preconditioner was set to the type above last.
[[nodiscard]] bool has_grids(PC preconditioner);

/// Gives the preconditioner the grids of multigrid/grid.hpp, nodes of which carry rigid motions, with the spacing of
/// the serial cycle. They span the whole assembly, so that iterations do not grow with the number of ranks. PETSc makes
/// the matrices of the grids (P^T K P), smooths by Chebyshev's iteration on the diagonal blocks, and eliminates on the
/// coarsest grid.
///
/// A rank holds the entries of its discs and nodes, and beside them 18 B for each node of the whole: 2.7 B for each
/// disc of the assembly, all grids together.
void build_grids(const Network& network, PC preconditioner);

}  // namespace equidem::petsc
