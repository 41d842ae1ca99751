// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Linear complementarity by Lemke's pivots on a full tableau, and by all supports.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>
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

/// The first of all supports of z that has an answer, where they are few: with friction pivots may end on a ray
/// although there is one. Numbers up to 1e-8 are round-off of entries of order 1.
inline bool complementary_by_supports(const std::vector<double>& m, const std::vector<double>& q,
                                      std::vector<double>& z) {
  constexpr double none = 1e-8;
  constexpr std::size_t most = 12;
  const std::size_t n = q.size();
  if (n > most) return false;
  for (std::size_t support = 0; support < (std::size_t{1} << n); ++support) {
    std::vector<std::size_t> rows;
    for (std::size_t r = 0; r < n; ++r)
      if ((support >> r & 1) != 0) rows.push_back(r);
    const std::size_t k = rows.size(), width = k + 1;
    std::vector<double> a(k * width);
    for (std::size_t r = 0; r < k; ++r) {
      for (std::size_t c = 0; c < k; ++c) a[r * width + c] = m[rows[r] * n + rows[c]];
      a[r * width + k] = -q[rows[r]];
    }
    bool regular = true;
    for (std::size_t p = 0; p < k && regular; ++p) {
      std::size_t row = p;
      for (std::size_t r = p; r < k; ++r)
        if (std::abs(a[r * width + p]) > std::abs(a[row * width + p])) row = r;
      regular = std::abs(a[row * width + p]) > none;
      for (std::size_t c = 0; c < width; ++c) std::swap(a[p * width + c], a[row * width + c]);
      for (std::size_t r = 0; r < k && regular; ++r) {
        const double f = r == p ? 0 : a[r * width + p] / a[p * width + p];
        for (std::size_t c = p; c < width && f != 0; ++c) a[r * width + c] -= f * a[p * width + c];
      }
    }
    if (!regular) continue;
    z.assign(n, 0.0);
    double size = 1;
    for (std::size_t r = 0; r < k; ++r) {
      z[rows[r]] = a[r * width + k] / a[r * width + r];
      size = std::max(size, std::abs(z[rows[r]]));
    }
    bool answer = true;
    for (std::size_t r = 0; r < n && answer; ++r) {
      double w = q[r];
      for (std::size_t c = 0; c < n; ++c) w += m[r * n + c] * z[c];
      answer = z[r] >= -none * size && w >= -none * size;
    }
    if (answer) return true;
  }
  return false;
}

}  // namespace equidem::test
