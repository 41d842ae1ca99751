// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The lowest eigenvalues of a large symmetric operator, by an approximate inverse.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "equidem/waves/tall_matrix.hpp"

namespace equidem {

/// A symmetric positive semidefinite operator A. Each function must give the same bits for the same columns.
struct SymmetricOperator {
  std::size_t size = 0;
  /// Columns of y = A times the same columns of x.
  std::function<void(const TallMatrix& x, ColumnRange columns, TallMatrix& y)> multiply;
  /// Columns := T times them, T an approximation of A^-1 where A has one; null vectors may be added to each.
  std::function<void(TallMatrix& x, ColumnRange columns)> precondition;
};

struct LowestOptions {
  std::size_t wanted = 4;   ///< number of eigenvalues, >= 1
  std::size_t guards = 4;   ///< vectors beside them, for speed
  double tolerance = 1e-6;  ///< of `error_bounds`, relative to the eigenvalue
  int iterations = 60;      ///< at most, >= 1
  std::uint64_t seed = 1;   ///< of the starting vectors
};

/// Ascending. Some eigenvalue of A lies within `error_bounds[k]` of `values[k]`, as far as T is the inverse of A to a
/// few per cent in the norm of energy; `values[k]` is not below the k-th eigenvalue.
struct LowestEigenvalues {
  std::vector<double> values;
  std::vector<double> error_bounds;  ///< sqrt(value r.T r), r = A x - value x, |x| = 1, with a margin
  TallMatrix vectors{0, 0};          ///< x
  int iterations = 0;
  bool converged = false;  ///< to the tolerance
};

/// Locally optimal block preconditioned conjugate gradients (Knyazev 2001) on an orthonormal basis of the vectors X,
/// the directions P of the last step (Hetmaniuk & Lehoucq 2006) and the preconditioned residuals W, without those of
/// the eigenvectors that have converged. With the exact inverse for T the space is that of a block Lanczos process
/// for A^-1 in two directions: multiple eigenvalues are found as often as they occur, up to `wanted` + `guards` times.
/// \param null orthonormal basis of the null space of A, which is left out
LowestEigenvalues lowest_eigenvalues(const SymmetricOperator& a, const TallMatrix& null,
                                     const LowestOptions& options = {});

}  // namespace equidem
