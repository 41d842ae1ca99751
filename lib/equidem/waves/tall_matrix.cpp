// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/waves/tall_matrix.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "equidem/core/threads.hpp"
#include "equidem/linear/multifrontal/dense_kernels.hpp"

namespace equidem {
namespace {

constexpr std::size_t rows_of_piece = 1 << 12;

}  // namespace

TallMatrix product_transposed(const TallMatrix& a, ColumnRange of_a, const TallMatrix& b, ColumnRange of_b) {
  const std::size_t rows = a.rows();
  TallMatrix sum(of_a.count, of_b.count);
  if (of_a.count == 0 || of_b.count == 0) return sum;
  const dense::OneThreadPerCall one_thread;
  std::vector<TallMatrix> parts((rows + rows_of_piece - 1) / rows_of_piece, sum);
  parallel_ranges(rows, rows_of_piece, [&](std::size_t begin, std::size_t end) {
    dense::subtract_transposed_product(of_a.count, of_b.count, end - begin, &a(begin, of_a.first), rows,
                                       &b(begin, of_b.first), rows, &parts[begin / rows_of_piece](0, 0), of_a.count);
  });
  for (const TallMatrix& part : parts) {
    for (std::size_t c = 0; c < of_b.count; ++c) {
      for (std::size_t r = 0; r < of_a.count; ++r) sum(r, c) -= part(r, c);
    }
  }
  return sum;
}

void subtract_product(const TallMatrix& a, ColumnRange of_a, const TallMatrix& c, TallMatrix& b, ColumnRange of_b) {
  if (of_a.count == 0 || of_b.count == 0) return;
  const std::size_t rows = a.rows();
  const dense::OneThreadPerCall one_thread;
  parallel_ranges(rows, rows_of_piece, [&](std::size_t begin, std::size_t end) {
    dense::subtract_product(end - begin, of_b.count, of_a.count, &a(begin, of_a.first), rows, &c(0, 0), c.rows(),
                            &b(begin, of_b.first), rows);
  });
}

void combine(TallMatrix& a, ColumnRange columns, const TallMatrix& c) {
  if (c.columns() == 0) return;
  const std::size_t rows = a.rows();
  TallMatrix negative(c.rows(), c.columns());
  std::ranges::transform(c.column(0, c.columns()), negative.column(0, c.columns()).begin(), std::negate<>());
  const dense::OneThreadPerCall one_thread;
  parallel_ranges(rows, rows_of_piece, [&](std::size_t begin, std::size_t end) {
    TallMatrix piece(end - begin, c.columns());
    dense::subtract_product(end - begin, c.columns(), columns.count, &a(begin, columns.first), rows, &negative(0, 0),
                            c.rows(), &piece(0, 0), end - begin);
    for (std::size_t k = 0; k < c.columns(); ++k) {
      std::ranges::copy(piece.column(k), &a(begin, columns.first + k));
    }
  });
}

void make_orthogonal_to(const TallMatrix& basis, ColumnRange of_basis, TallMatrix& a, ColumnRange columns) {
  for (int pass = 0; pass < 2; ++pass) {
    subtract_product(basis, of_basis, product_transposed(basis, of_basis, a, columns), a, columns);
  }
}

std::size_t make_orthonormal(TallMatrix& a, ColumnRange columns) {
  constexpr double dependent = 1e-13;  // of the largest eigenvalue of the Gram matrix of unit columns
  for (int pass = 0; pass < 2 && columns.count > 0; ++pass) {
    const std::size_t n = columns.count;
    TallMatrix gram = product_transposed(a, columns, a, columns);
    std::vector<double> over(n), values(n);
    for (std::size_t k = 0; k < n; ++k) over[k] = gram(k, k) > 0 ? 1 / std::sqrt(gram(k, k)) : 0;
    for (std::size_t c = 0; c < n; ++c) {
      for (std::size_t r = 0; r < n; ++r) gram(r, c) *= over[r] * over[c];
    }
    if (dense::find_spectrum(n, &gram(0, 0), values.data(), true) != 0) return 0;
    std::size_t dropped = 0;
    while (dropped < n && !(values[dropped] > dependent * values.back())) ++dropped;
    TallMatrix turn(n, n - dropped);
    for (std::size_t c = 0; c < turn.columns(); ++c) {
      for (std::size_t r = 0; r < n; ++r) turn(r, c) = over[r] * gram(r, dropped + c) / std::sqrt(values[dropped + c]);
    }
    combine(a, columns, turn);
    columns.count -= dropped;
  }
  return columns.count;
}

}  // namespace equidem
