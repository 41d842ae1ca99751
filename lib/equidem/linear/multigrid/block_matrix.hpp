// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Vectors and sparse matrices of 3 x 3 blocks in single precision, Chebyshev smoothing, and the factorization on the
/// coarsest grid.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "equidem/linear/large_buffer.hpp"

namespace equidem::multigrid {

/// The three unknowns of a row in one register; the fourth number has no meaning and is never read.
using Quad = float __attribute__((vector_size(16)));
using QuadVector = LargeVector<Quad>;

struct RowRange {
  std::size_t begin = 0, end = 0;
};

/// One step: next = x + keep (x - before) + add D^-1 (b - A x), D the diagonal blocks.
struct ChebyshevStep {
  float keep = 0, add = 0;
  bool from_zero = false;  ///< `before` is 0, else what `next` holds
};

/// Chebyshev iteration on D^-1 A over the interval [largest / range, largest] of its eigenvalues (Saad 2003, algorithm
/// 12.1). As a polynomial in D^-1 A it is symmetric in the product of D.
/// \param degree products with D^-1 A, >= 1
/// \param from_zero whether x is 0 at the beginning: the first step is then x = add D^-1 b
std::vector<ChebyshevStep> chebyshev_steps(int degree, double largest, double range, bool from_zero);

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
};

/// Rows are stored from their first entry on (Jennings 1966). Unknowns without stiffness of their own, beside those
/// before them, are held at 0, so that a semidefinite matrix is no obstacle.
class EnvelopeCholesky {
 public:
  EnvelopeCholesky() = default;
  explicit EnvelopeCholesky(const BlockMatrix& matrix);
  /// x := A^-1 b.
  void solve(const QuadVector& b, QuadVector& x) const;
  [[nodiscard]] double bytes() const { return 8.0 * static_cast<double>(values_.size()); }

 private:
  [[nodiscard]] const double* row(std::size_t k) const { return &values_[start_[k]] - first_[k]; }

  std::vector<std::size_t> first_, start_;  // per row: its first column, the place of that entry
  std::vector<double> values_;              // of L; the diagonal inverted, 0 where held
};

}  // namespace equidem::multigrid
