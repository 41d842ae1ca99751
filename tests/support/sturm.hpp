// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// How many eigenvalues of a dense symmetric matrix lie below a number: Householder's reduction to a tridiagonal
/// matrix, then a Sturm sequence (Golub & Van Loan, Matrix Computations, sections 8.3 and 8.4). Nothing iterates.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "support/dense_oracle.hpp"

namespace equidem::test {

struct Tridiagonal {
  std::vector<double> diagonal, below;  ///< below[k] couples k and k + 1
  double norm = 0;                      ///< bound on |eigenvalue| (Gershgorin)
};

inline Tridiagonal tridiagonalize(DenseMatrix a) {
  const std::size_t n = a.size;
  std::vector<double> v(n), w(n);
  for (std::size_t k = 0; k + 2 < n; ++k) {
    double length = 0;
    for (std::size_t r = k + 1; r < n; ++r) length = std::hypot(length, a(r, k));
    if (length == 0) continue;
    for (std::size_t r = k + 1; r < n; ++r) v[r] = a(r, k);
    v[k + 1] += std::copysign(length, a(k + 1, k));
    double square = 0, vw = 0;
    for (std::size_t r = k + 1; r < n; ++r) square += v[r] * v[r];
    for (std::size_t r = k + 1; r < n; ++r) {
      w[r] = 0;
      for (std::size_t c = k + 1; c < n; ++c) w[r] += 2 / square * a(r, c) * v[c];
      vw += v[r] * w[r];
    }
    for (std::size_t r = k + 1; r < n; ++r) w[r] -= vw / square * v[r];
    for (std::size_t r = k + 1; r < n; ++r) {
      for (std::size_t c = k + 1; c < n; ++c) a(r, c) -= v[r] * w[c] + w[r] * v[c];
    }
    a(k + 1, k) = -std::copysign(length, a(k + 1, k));
  }
  Tridiagonal t;
  for (std::size_t k = 0; k < n; ++k) {
    t.diagonal.push_back(a(k, k));
    if (k + 1 < n) t.below.push_back(a(k + 1, k));
  }
  for (std::size_t k = 0; k < n; ++k) {
    const double left = k > 0 ? std::abs(t.below[k - 1]) : 0, right = k + 1 < n ? std::abs(t.below[k]) : 0;
    t.norm = std::max(t.norm, std::abs(t.diagonal[k]) + left + right);
  }
  return t;
}

inline std::int64_t eigenvalues_below(const Tridiagonal& t, double x) {
  std::int64_t count = 0;
  double q = 1;
  for (std::size_t k = 0; k < t.diagonal.size(); ++k) {
    const double coupling = k > 0 ? t.below[k - 1] * t.below[k - 1] : 0;
    q = t.diagonal[k] - x - (k > 0 ? coupling / q : 0);
    if (q == 0) q = std::numeric_limits<double>::epsilon() * t.norm + std::numeric_limits<double>::min();
    if (q < 0) ++count;
  }
  return count;
}

/// Eigenvalues below, within and above +-tolerance times the norm.
struct Signs {
  std::int64_t negative = 0, zero = 0, positive = 0;
};
inline Signs signs_of(const DenseMatrix& a, double tolerance) {
  const Tridiagonal t = tridiagonalize(a);
  if (t.norm == 0) return {0, static_cast<std::int64_t>(a.size), 0};
  const std::int64_t negative = eigenvalues_below(t, -tolerance * t.norm);
  const std::int64_t not_positive = eigenvalues_below(t, tolerance * t.norm);
  return {negative, not_positive - negative, static_cast<std::int64_t>(a.size) - not_positive};
}

}  // namespace equidem::test
