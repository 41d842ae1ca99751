// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Chebyshev smoothing, and the vectors that it works on.
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

}  // namespace equidem::multigrid
