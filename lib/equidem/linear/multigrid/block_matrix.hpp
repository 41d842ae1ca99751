// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Sparse matrices of 3 x 3 blocks in single precision, and the Chebyshev smoother on them.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "equidem/linear/large_buffer.hpp"

namespace equidem::multigrid {

/// The three unknowns of a row in one register; the fourth number has no meaning and is never read.
using Quad = float __attribute__((vector_size(16)));
using QuadVector = LargeVector<Quad>;

using Block = std::array<double, 9>;  ///< 3 x 3, row-major

/// The inverse of a symmetric positive semidefinite block. Components that are (nearly) combinations of those before
/// them have rows and columns of zeros instead: relaxation leaves them alone.
Block inverse_or_zero(const Block& block);

/// A symmetric matrix by rows. Components that are no unknowns have rows and columns of zeros.
struct BlockMatrix {
  std::vector<std::int64_t> first;    ///< rows + 1
  LargeVector<std::int32_t> columns;  ///< per entry
  LargeVector<float> blocks;          ///< per entry 3 x 3, column-major, and one number beyond the last
  LargeVector<float> inverse;         ///< per row, of the diagonal block, likewise: inverse_or_zero

  [[nodiscard]] std::size_t rows() const { return first.size() - 1; }
  /// Make room for the entries that `first` announces.
  void resize();
  void set(std::int64_t entry, std::size_t column, const Block& block);
  void set_inverse(std::size_t row, const Block& diagonal);
  [[nodiscard]] double bytes() const;
};

/// r = b - A x.
void residual(const BlockMatrix& a, const QuadVector& b, const QuadVector& x, QuadVector& r);

/// The largest eigenvalue of D^-1 A, D the diagonal blocks, by power iteration: a few per cent too small.
double largest_eigenvalue(const BlockMatrix& a, int iterations);

/// Chebyshev iteration on D^-1 A over the interval [largest / range, largest] of its eigenvalues (Saad 2003, algorithm
/// 12.1). As a polynomial in D^-1 A it is symmetric in the product of D.
struct Smoother {
  int degree = 2;  ///< products with A, one less from x = 0
  double largest = 2;
  double range = 6;

  /// \param from_zero whether to start from 0 instead of x
  /// \param step, next are scratch; x and next may be exchanged
  void apply(const BlockMatrix& a, const QuadVector& b, QuadVector& x, QuadVector& step, QuadVector& next,
             bool from_zero) const;
};

}  // namespace equidem::multigrid
