// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Matrices of a few long columns: products, combinations and orthonormal bases on all threads, with the same bits for
/// any number of them.
#pragma once

#include <cstddef>
#include <span>

#include "equidem/linear/large_buffer.hpp"

namespace equidem {

class TallMatrix {
 public:
  TallMatrix(std::size_t rows, std::size_t columns) : rows_(rows), columns_(columns), numbers_(rows * columns, 0.0) {}

  [[nodiscard]] std::size_t rows() const { return rows_; }
  [[nodiscard]] std::size_t columns() const { return columns_; }
  [[nodiscard]] std::span<double> column(std::size_t k, std::size_t count = 1) {
    return {numbers_.data() + k * rows_, count * rows_};
  }
  [[nodiscard]] std::span<const double> column(std::size_t k, std::size_t count = 1) const {
    return {numbers_.data() + k * rows_, count * rows_};
  }
  double& operator()(std::size_t row, std::size_t column) { return numbers_[column * rows_ + row]; }
  const double& operator()(std::size_t row, std::size_t column) const { return numbers_[column * rows_ + row]; }

 private:
  std::size_t rows_, columns_;
  LargeVector<double> numbers_;  // column by column
};

/// Columns [first, first + count) of a matrix.
struct ColumnRange {
  std::size_t first = 0, count = 0;
};

/// A^T B of columns of two matrices with the same number of rows.
TallMatrix product_transposed(const TallMatrix& a, ColumnRange of_a, const TallMatrix& b, ColumnRange of_b);
/// Columns of B -= columns of A times C. A and B may be one matrix, with separate columns.
void subtract_product(const TallMatrix& a, ColumnRange of_a, const TallMatrix& c, TallMatrix& b, ColumnRange of_b);
/// The first columns of a range of A := the columns of that range times C, which has no more columns than rows.
void combine(TallMatrix& a, ColumnRange columns, const TallMatrix& c);
/// Columns are made orthogonal to an orthonormal set.
void make_orthogonal_to(const TallMatrix& basis, ColumnRange of_basis, TallMatrix& a, ColumnRange columns);
/// Columns are made orthonormal among themselves, from the eigenvectors of their Gram matrix (Stathopoulos & Wu 2002).
/// \returns the number, at the front of the range, of those that are independent to working precision
std::size_t make_orthonormal(TallMatrix& a, ColumnRange columns);

}  // namespace equidem
