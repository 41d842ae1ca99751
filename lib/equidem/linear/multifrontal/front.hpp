// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Steps on one front of a multifrontal factorization, shared by Cholesky and L D L^T.
#pragma once

#include <cstddef>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/linear/contact_graph.hpp"
#include "equidem/linear/ordering/symbolic_factor.hpp"
#include "equidem/linear/stiffness_matrix.hpp"

namespace equidem {

/// Add the columns of K that front t eliminates to its panel: own unknowns first, then those of its rows,
/// column-major with leading dimension `ld`; only entries on and below the diagonal.
void add_matrix_columns(const SymbolicFactor& symbolic, const MatrixOnGraph& k, std::size_t t, double* panel,
                        std::size_t ld);

/// Factorize a front: panel (k + m rows, k columns) and update matrix (m x m, leading dimension m, lower triangle).
/// Large fronts are worked on in tiles, by all threads where they are free; the tiles, and so the bits, are always
/// the same. Returns 0, or the 1-based index of the first pivot that is not positive.
int factorize_front(std::size_t k, std::size_t m, double* panel, double* update);

/// A column-major matrix inside a larger one.
template <typename Value>
struct Strided {
  Value* data;
  std::size_t ld;
};

/// Lower triangle of C (m x m) -= A B^T for A, B of m rows and k columns, in tiles, by all threads where they are
/// free.
void subtract_in_tiles(std::size_t m, std::size_t k, Strided<const double> a, Strided<const double> b,
                       Strided<double> c);

/// Add the update matrix of a child to its parent's panel and update matrix, along the runs of match_rows.
struct ParentFront {
  double* panel;
  std::size_t ld;  ///< of the panel
  double* update;
  std::size_t own;  ///< discs that the parent eliminates
};
void extend_add(const std::vector<RowRun>& runs, int block, const double* child, std::size_t child_size,
                const ParentFront& parent);

}  // namespace equidem
