// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Steps on one front of a multifrontal factorization, shared by Cholesky and L D L^T.
#pragma once

#include <complex>
#include <cstddef>
#include <span>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/linear/contact_graph.hpp"
#include "equidem/linear/ordering/symbolic_factor.hpp"
#include "equidem/linear/stiffness_matrix.hpp"

namespace equidem {

// The templates below are there for float and double; the columns of K and products in tiles also for
// std::complex<double>.

/// Add the columns of K that front t eliminates to its panel: own unknowns first, then those of its rows,
/// column-major with leading dimension `ld`; only entries on and below the diagonal.
/// \param scale per component: row and column are multiplied by it; empty: 1
template <typename Real, typename Entry>
void add_matrix_columns(const SymbolicFactor& symbolic, const MatrixOnGraphOf<Entry>& k, std::size_t t,
                        std::span<const double> scale, Real* panel, std::size_t ld);

/// Factorize a front: panel (k + m rows, k columns) and update matrix (m x m, leading dimension m, lower triangle).
/// Large fronts are worked on in tiles, by all threads where they are free; the tiles, and so the bits, are always
/// the same. Returns 0, or the 1-based index of the first pivot that is not positive.
template <typename Real>
int factorize_front(std::size_t k, std::size_t m, Real* panel, Real* update);

/// A column-major matrix inside a larger one.
template <typename Number>
struct Strided {
  Number* data;
  std::size_t ld;
};

/// Lower triangle of C (m x m) -= A B^T for A, B of m rows and k columns, in tiles, by all threads where they are
/// free.
template <typename Real>
void subtract_in_tiles(std::size_t m, std::size_t k, Strided<const Real> a, Strided<const Real> b, Strided<Real> c);

/// Add the update matrix of a child to its parent's panel and update matrix, along the runs of match_rows.
template <typename Real>
struct ParentFront {
  Real* panel;
  std::size_t ld;  ///< of the panel
  Real* update;
  std::size_t own;  ///< discs that the parent eliminates
};
template <typename Real>
void extend_add(const std::vector<RowRun>& runs, int block, const Real* child, std::size_t child_size,
                const ParentFront<Real>& parent);

}  // namespace equidem
