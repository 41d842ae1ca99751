// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The point that lies farthest within all of some half-spaces, by the simplex method with Bland's rule.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

namespace equidem {

struct WidestPoint {
  double margin = 0;          ///< negative: no point lies in all of them
  std::vector<double> place;  ///< x
};

/// Maximizes the least of `most` and of all g_i + h_i x over x without a sign.
/// \param g one for each half-space
/// \param h row by row, one for each half-space
/// \param negligible coefficients below are round-off
inline WidestPoint widest_point(std::span<const double> g, std::span<const double> h, std::size_t unknowns, double most,
                                double negligible) {
  // Variables: x, the margin t, the distances s_i = g_i + h_i x - t >= 0, and the last one of s = most - t. Rows give
  // the basic variables by those that are 0; x and t have no sign and never leave the basis.
  const std::size_t n = unknowns + 1, width = n + 1, rows = g.size() + 1, t = unknowns;
  std::vector<double> a(rows * width, 0.0), aim(width, 0.0);
  std::vector<std::size_t> basic(rows), zero(n);
  for (std::size_t r = 0; r < rows; ++r) {
    const bool last = r == g.size();
    a[r * width] = last ? most : g[r];
    for (std::size_t k = 0; k < unknowns && !last; ++k)
      a[r * width + 1 + k] = std::abs(h[r * unknowns + k]) > negligible ? h[r * unknowns + k] : 0;
    a[r * width + 1 + t] = -1;
    basic[r] = n + r;
  }
  for (std::size_t k = 0; k < n; ++k) zero[k] = k;
  aim[1 + t] = 1;
  const auto pivot = [&](std::size_t row, std::size_t column) {
    double* const by = &a[row * width];
    const double p = by[1 + column];
    for (std::size_t c = 0; c < width; ++c) by[c] /= c == 1 + column ? 1 : -p;
    by[1 + column] = 1 / p;
    const auto eliminate = [&](double* line) {
      const double f = std::exchange(line[1 + column], 0.0);
      for (std::size_t c = 0; c < width && f != 0; ++c) line[c] += f * by[c];
    };
    for (std::size_t r = 0; r < rows; ++r)
      if (r != row) eliminate(&a[r * width]);
    eliminate(aim.data());
    std::swap(basic[row], zero[column]);
  };
  // The margin of x = 0 is where the first distance vanishes.
  std::size_t first = 0;
  for (std::size_t r = 1; r < rows; ++r)
    if (a[r * width] < a[first * width]) first = r;
  pivot(first, t);
  constexpr int most_pivots = 10000;
  for (int k = 0; k < most_pivots; ++k) {
    std::size_t entering = n;
    for (std::size_t c = 0; c < n; ++c) {
      const bool improves = aim[1 + c] > negligible || (zero[c] < n && aim[1 + c] < -negligible);
      if (improves && (entering == n || zero[c] < zero[entering])) entering = c;
    }
    if (entering == n) break;
    const double sign = aim[1 + entering] > 0 ? 1 : -1;
    std::size_t leaving = rows;
    double least = 0;
    for (std::size_t r = 0; r < rows; ++r) {
      const double slope = sign * a[r * width + 1 + entering];
      if (basic[r] < n || slope >= -negligible) continue;
      const double way = std::max(a[r * width], 0.0) / -slope;
      if (leaving == rows || way < least || (way == least && basic[r] < basic[leaving])) leaving = r, least = way;
    }
    if (leaving == rows) break;
    pivot(leaving, entering);
  }
  WidestPoint result{aim[0], std::vector<double>(unknowns, 0.0)};
  for (std::size_t r = 0; r < rows; ++r)
    if (basic[r] < unknowns) result.place[basic[r]] = a[r * width];
  return result;
}

}  // namespace equidem
