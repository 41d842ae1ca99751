// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Small dense systems by Gaussian elimination with row pivoting.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

namespace equidem {

/// L U of a square matrix, row-major, in its place.
/// \return the least pivot over the largest entry of the matrix; 0: it is singular
inline double factorize_dense(std::span<double> a, std::vector<std::size_t>& pivots) {
  const auto n = static_cast<std::size_t>(std::lround(std::sqrt(static_cast<double>(a.size()))));
  pivots.resize(n);
  double largest = 0, least = 1;
  for (const double x : a) largest = std::max(largest, std::abs(x));
  for (std::size_t k = 0; k < n; ++k) {
    std::size_t p = k;
    for (std::size_t r = k + 1; r < n; ++r) {
      if (std::abs(a[r * n + k]) > std::abs(a[p * n + k])) p = r;
    }
    pivots[k] = p;
    const double pivot = a[p * n + k];
    if (!(std::abs(pivot) > 0)) return 0;
    least = std::min(least, std::abs(pivot) / largest);
    for (std::size_t c = 0; c < n && p != k; ++c) std::swap(a[k * n + c], a[p * n + c]);
    for (std::size_t r = k + 1; r < n; ++r) {
      const double factor = a[r * n + k] /= pivot;
      for (std::size_t c = k + 1; c < n && factor != 0; ++c) a[r * n + c] -= factor * a[k * n + c];
    }
  }
  return least;
}

inline void solve_dense(std::span<const double> lu, std::span<const std::size_t> pivots, std::span<double> x) {
  const std::size_t n = pivots.size();
  for (std::size_t k = 0; k < n; ++k) std::swap(x[k], x[pivots[k]]);
  for (std::size_t r = 0; r < n; ++r) {
    for (std::size_t c = 0; c < r; ++c) x[r] -= lu[r * n + c] * x[c];
  }
  for (std::size_t r = n; r-- > 0;) {
    for (std::size_t c = r + 1; c < n; ++c) x[r] -= lu[r * n + c] * x[c];
    x[r] /= lu[r * n + r];
  }
}

}  // namespace equidem
