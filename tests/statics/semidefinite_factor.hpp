// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Dense positive semi-definite systems in extended precision.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

namespace equidem::test {

using Number = long double;  // random networks come near to mechanisms
using Vector = std::vector<Number>;
using LongMatrix = std::vector<Vector>;

inline Number dot(const Vector& x, const Vector& y) {
  return std::inner_product(x.begin(), x.end(), y.begin(), Number{0});
}

inline double largest_of(const Vector& x) {
  Number size = 0;
  for (const Number value : x) size = std::max(size, std::abs(value));
  return static_cast<double>(size);
}

/// Cholesky's factorization of a positive semi-definite matrix of entries of order 1 that takes the largest diagonal
/// first and stops where only rounding is left.
struct SemidefiniteFactor {
  LongMatrix l;
  std::vector<std::size_t> pivots;
  Number smallest = 1, left_over = 0;

  explicit SemidefiniteFactor(LongMatrix a) {
    const std::size_t n = a.size();
    std::vector<bool> done(n, false);
    for (std::size_t step = 0; step < n; ++step) {
      std::size_t p = n;
      for (std::size_t r = 0; r < n; ++r) {
        if (!done[r] && (p == n || a[r][r] > a[p][p])) p = r;
      }
      if (a[p][p] < 1e-11) {
        left_over = std::abs(a[p][p]);
        break;
      }
      smallest = std::min(smallest, a[p][p]);
      done[p] = true;
      pivots.push_back(p);
      const Number root = std::sqrt(a[p][p]);
      Vector column(n, 0);
      for (std::size_t r = 0; r < n; ++r) column[r] = !done[r] || r == p ? a[r][p] / root : 0;
      for (std::size_t r = 0; r < n; ++r) {
        if (done[r]) continue;
        for (std::size_t c = 0; c < n; ++c) a[r][c] -= column[r] * column[c];
      }
      l.push_back(std::move(column));
    }
  }

  [[nodiscard]] std::int64_t rank() const { return static_cast<std::int64_t>(pivots.size()); }
  /// A solution, zero in all components but the pivots.
  [[nodiscard]] Vector solve(Vector b) const {
    Vector x(b.size(), 0.0);
    Vector y(pivots.size());
    for (std::size_t k = 0; k < pivots.size(); ++k) {
      y[k] = b[pivots[k]] / l[k][pivots[k]];
      for (std::size_t r = 0; r < b.size(); ++r) b[r] -= l[k][r] * y[k];
    }
    for (std::size_t k = pivots.size(); k-- > 0;) {
      for (std::size_t later = k + 1; later < pivots.size(); ++later) y[k] -= l[k][pivots[later]] * x[pivots[later]];
      x[pivots[k]] = y[k] / l[k][pivots[k]];
    }
    return x;
  }
};

}  // namespace equidem::test
