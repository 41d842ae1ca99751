// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Steps on one dense front of a multifrontal factorization by Cholesky and by L D L^T.
#pragma once

#include <cstddef>
#include <cstdint>
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

/// A symmetric front: lower triangle, column-major, leading dimension `size`. Its first `candidates` rows are fully
/// summed: pivots are chosen among them.
struct IndefiniteFront {
  std::size_t size = 0;
  std::size_t candidates = 0;
  double* values = nullptr;
  std::vector<std::int64_t> ids;  ///< what each row stands for; permuted along with the rows
};

/// The pivots of a front in the order of elimination. Column p of L (unit diagonal) is left in column p of the front.
struct FrontPivots {
  std::size_t count = 0;
  std::vector<double> diagonal;      ///< D_pp
  std::vector<double> off_diagonal;  ///< D_p+1,p where p opens a 2 x 2 pivot, else 0
  double growth = 0;                 ///< largest |L_ij|
};

/// Eliminate candidates one or two at a time (Duff & Reid 1983; Ashcraft, Grimes & Lewis 1998): a 1 x 1 pivot d is
/// taken where |d| >= u max |column|, a 2 x 2 pivot D where |D^-1| |columns| <= 1/u, so that |L_ij| <= 1/u.
/// Candidates that pass neither test stay behind, after the pivots, for a later front. Entries at or below `zero`
/// count as zero. The rows that are left are updated: the Schur complement stands in rows and columns count ..
/// size.
/// \param u threshold, in (0, 1/2]
FrontPivots factorize_indefinite(IndefiniteFront& front, double u, double zero);

}  // namespace equidem
