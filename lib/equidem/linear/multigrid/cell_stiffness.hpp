// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Stiffness matrices of the cells of a grid. The energy of a contact goes into the one cell that holds its midpoint,
/// whose functions move both of its discs: the matrix on the nodes is positive semidefinite and couples a node to the
/// eight around it only, where the exact projection of K would couple 22.
#pragma once

#include <span>

#include "equidem/contact/contact_springs.hpp"
#include "equidem/linear/large_buffer.hpp"
#include "equidem/linear/multigrid/block_matrix.hpp"
#include "equidem/linear/multigrid/grid.hpp"
#include "equidem/linear/multigrid/transfer.hpp"
#include "equidem/linear/stiffness_matrix.hpp"

namespace equidem::multigrid {

/// 12 x 12 entries per cell: four nodes of three unknowns.
using CellStiffness = LargeVector<double>;

/// \param unit Pa, by which springs are divided
CellStiffness stiffness_of_contacts(const Grid& grid, const Assembly& assembly, const ContactSprings& springs,
                                    const DegreesOfFreedom& unknowns, double unit);
/// Projects the energies of the cells of a fine grid: its nodes are moved by the functions of the cells of `coarse`.
CellStiffness stiffness_on_coarser(const Grid& coarse, const Grid& fine, const CellStiffness& cells);

/// The matrix on the numbered nodes of the grid.
BlockMatrix assemble_cells(const Transfer& numbering, const CellStiffness& cells);

}  // namespace equidem::multigrid
