// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Sparse matrices of 3 x 3 blocks in single precision.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "equidem/linear/large_buffer.hpp"

namespace equidem::multigrid {

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

}  // namespace equidem::multigrid
