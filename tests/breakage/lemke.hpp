// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Linear complementarity by Lemke's pivots on a full tableau.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

namespace equidem::test {

/// w = q + M z >= 0, z >= 0, w z = 0 by Lemke's method. \return false where it ends on a ray
inline bool lemke(std::vector<double> m, std::vector<double> q, std::vector<double>& z) {
  const std::size_t n = q.size();
  z.assign(n, 0.0);
  // Columns: w (n), z (n), z0, right-hand side.
  const std::size_t width = 2 * n + 2;
  std::vector<double> t(n * width, 0.0);
  std::vector<std::size_t> basis(n);
  for (std::size_t r = 0; r < n; ++r) {
    t[r * width + r] = 1;
    for (std::size_t c = 0; c < n; ++c) t[r * width + n + c] = -m[r * n + c];
    t[r * width + 2 * n] = -1 - 1e-3 * static_cast<double>(r + 1) / static_cast<double>(n);
    t[r * width + 2 * n + 1] = q[r];
    basis[r] = r;
  }
  const auto pivot = [&](std::size_t row, std::size_t column) {
    const double p = t[row * width + column];
    for (std::size_t c = 0; c < width; ++c) t[row * width + c] /= p;
    for (std::size_t r = 0; r < n; ++r) {
      const double f = t[r * width + column];
      if (r == row || f == 0) continue;
      for (std::size_t c = 0; c < width; ++c) t[r * width + c] -= f * t[row * width + c];
    }
  };
  std::size_t row = 0;
  double least = 0;
  for (std::size_t r = 0; r < n; ++r) {
    const double ratio = q[r] / -t[r * width + 2 * n];
    if (ratio < least) least = ratio, row = r;
  }
  if (least >= 0) return true;
  std::size_t entering = 2 * n;
  for (int k = 0; k < 5000; ++k) {
    const std::size_t leaving = basis[row];
    pivot(row, entering);
    basis[row] = entering;
    if (leaving == 2 * n) break;
    entering = leaving < n ? leaving + n : leaving - n;
    double best = std::numeric_limits<double>::infinity();
    std::size_t found = n;
    for (std::size_t r = 0; r < n; ++r) {
      const double a = t[r * width + entering];
      if (a < 1e-9) continue;
      const double ratio = t[r * width + width - 1] / a;
      const bool tie = found < n && std::abs(ratio - best) <= 1e-12 * std::max(1.0, std::abs(best));
      if ((!tie && ratio < best) || (tie && basis[r] == 2 * n)) best = ratio, found = r;
    }
    if (found == n) return false;
    row = found;
  }
  for (std::size_t r = 0; r < n; ++r) {
    if (basis[r] == 2 * n && std::abs(t[r * width + width - 1]) > 1e-9) return false;
    if (basis[r] >= n && basis[r] < 2 * n) z[basis[r] - n] = t[r * width + width - 1];
  }
  return true;
}

}  // namespace equidem::test
