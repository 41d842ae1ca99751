// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Stiffness matrices as those of Eigen. The library needs no Eigen for it: its user includes <Eigen/SparseCore>.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/linear/stiffness_matrix.hpp"

namespace equidem {

/// The matrix in the column format of Eigen: the lower triangle where `columns` is one, as Eigen::SimplicialLLT takes
/// it, all entries where it comes from with_upper_triangle.
/// \tparam Matrix Eigen::SparseMatrix<double>, or one with another StorageIndex; column-major
/// \throws Error (bad_input) where the matrix has more entries than StorageIndex counts
template <class Matrix>
Matrix eigen_matrix(const CompressedColumns& columns) {
  static_assert(!Matrix::IsRowMajor, "the entries are given column by column");
  using Index = typename Matrix::StorageIndex;
  if (columns.first.back() > std::int64_t{std::numeric_limits<Index>::max()})
    bad_input(fmt::format("the matrix has {} entries", columns.first.back()), "the StorageIndex is too short",
              "Use Eigen::SparseMatrix<double, Eigen::ColMajor, std::int64_t>");
  Matrix matrix(columns.size, columns.size);
  matrix.resizeNonZeros(columns.first.back());
  const auto to_index = [](std::int64_t value) { return static_cast<Index>(value); };
  std::transform(columns.first.begin(), columns.first.end(), matrix.outerIndexPtr(), to_index);
  std::transform(columns.rows.begin(), columns.rows.end(), matrix.innerIndexPtr(), to_index);
  std::copy(columns.values.begin(), columns.values.end(), matrix.valuePtr());
  return matrix;
}

}  // namespace equidem
