// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The matrix of one level as the smoother uses it: by ranges of rows.
#pragma once

#include <cstddef>
#include <vector>

#include "equidem/linear/large_buffer.hpp"

namespace equidem::multigrid {

/// The three unknowns of a row in one register; the fourth number has no meaning and is never read.
using Quad = float __attribute__((vector_size(16)));
using QuadVector = LargeVector<Quad>;

struct RowRange {
  std::size_t begin = 0, end = 0;
};

/// One step of Chebyshev iteration: next = x + keep (x - before) + add D^-1 (b - A x), D the diagonal blocks.
struct ChebyshevStep {
  float keep = 0, add = 0;
  bool from_zero = false;  ///< `before` is 0, else what `next` holds
};

/// A symmetric matrix with rows of three unknowns. Components that are no unknowns have rows and columns of zeros.
/// Functions on a range write these rows only.
class SmoothedMatrix {
 public:
  SmoothedMatrix() = default;
  virtual ~SmoothedMatrix() = default;
  SmoothedMatrix(const SmoothedMatrix&) = default;
  SmoothedMatrix& operator=(const SmoothedMatrix&) = default;
  SmoothedMatrix(SmoothedMatrix&&) = default;
  SmoothedMatrix& operator=(SmoothedMatrix&&) = default;

  [[nodiscard]] virtual std::size_t rows() const = 0;
  /// The smallest range that holds the columns of these rows and the rows themselves.
  [[nodiscard]] virtual RowRange reach(RowRange rows) const = 0;
  /// x = factor D^-1 b.
  virtual void start(RowRange rows, float factor, const Quad* b, Quad* x) const = 0;
  virtual void advance(RowRange rows, const ChebyshevStep& step, const Quad* b, const Quad* x, Quad* next) const = 0;
  /// x = 0 where it is held.
  virtual void hold(RowRange, Quad*) const {}
  /// r = b - A x.
  virtual void residual(RowRange rows, const Quad* b, const Quad* x, Quad* r) const = 0;
  [[nodiscard]] virtual double bytes() const = 0;
};

/// r = b - A x over all rows.
void residual(const SmoothedMatrix& a, const QuadVector& b, const QuadVector& x, QuadVector& r);

/// Chebyshev iteration on D^-1 A over the interval [largest / range, largest] of its eigenvalues (Saad 2003, algorithm
/// 12.1). As a polynomial in D^-1 A it is symmetric in the product of D.
/// \param degree products with D^-1 A, >= 1 \param from_zero whether x is 0 at the beginning: the first step is then
///        x = add D^-1 b
std::vector<ChebyshevStep> chebyshev_steps(int degree, double largest, double range, bool from_zero);

}  // namespace equidem::multigrid
