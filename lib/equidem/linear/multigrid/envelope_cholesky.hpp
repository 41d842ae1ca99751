// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Cholesky factorization within the envelope of a small matrix, for the coarsest grid.
#pragma once

#include <cstddef>
#include <vector>

#include "equidem/linear/multigrid/block_matrix.hpp"
#include "equidem/linear/multigrid/smoother.hpp"

namespace equidem::multigrid {

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
