// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/linear/multigrid/envelope_cholesky.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace equidem::multigrid {

EnvelopeCholesky::EnvelopeCholesky(const BlockMatrix& matrix) {
  const std::size_t n = 3 * matrix.rows();
  first_.resize(n);
  start_.resize(n);
  std::size_t total = 0;
  for (std::size_t r = 0; r < n; ++r) {
    std::size_t least = r / 3;
    for (std::int64_t e = matrix.first[r / 3]; e < matrix.first[r / 3 + 1]; ++e) {
      least = std::min(least, static_cast<std::size_t>(matrix.columns[e]));
    }
    first_[r] = 3 * least;
    start_[r] = total;
    total += r + 1 - first_[r];
  }
  values_.assign(total, 0.0);
  for (std::size_t r = 0; r < n; ++r) {
    double* to = &values_[start_[r]] - first_[r];
    for (std::int64_t e = matrix.first[r / 3]; e < matrix.first[r / 3 + 1]; ++e) {
      for (std::size_t c = 0; c < 3; ++c) {
        const std::size_t column = 3 * static_cast<std::size_t>(matrix.columns[e]) + c;
        if (column <= r) to[column] += matrix.blocks[9 * e + 3 * c + r % 3];
      }
    }
  }
  constexpr double nothing = 1e-6;  // share of a diagonal entry: rounding of the entries in float
  for (std::size_t r = 0; r < n; ++r) {
    double* to = &values_[start_[r]] - first_[r];
    double pivot = to[r];
    for (std::size_t c = first_[r]; c < r; ++c) {
      const double* other = row(c);
      const std::size_t begin = std::max(first_[r], first_[c]);
      to[c] = (to[c] - std::inner_product(to + begin, to + c, other + begin, 0.0)) * other[c];
      pivot -= to[c] * to[c];
    }
    to[r] = pivot > nothing * to[r] ? 1 / std::sqrt(pivot) : 0;
  }
}

void EnvelopeCholesky::solve(const QuadVector& b, QuadVector& x) const {
  const std::size_t n = first_.size();
  std::vector<double> y(n);
  for (std::size_t r = 0; r < n; ++r) {
    const double* l = row(r);
    y[r] = (b[r / 3][r % 3] - std::inner_product(l + first_[r], l + r, y.begin() + first_[r], 0.0)) * l[r];
  }
  for (std::size_t r = n; r-- > 0;) {
    const double* l = row(r);
    y[r] *= l[r];
    for (std::size_t c = first_[r]; c < r; ++c) y[c] -= l[c] * y[r];
  }
  for (std::size_t r = 0; r < n; ++r) x[r / 3][r % 3] = static_cast<float>(y[r]);
}

}  // namespace equidem::multigrid
