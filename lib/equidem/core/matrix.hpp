// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Small square matrices: stiffness and compliance tensors in Voigt order.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace equidem {

template <std::size_t N>
using SquareMatrix = std::array<std::array<double, N>, N>;

/// Rows and columns in Voigt order (xx, yy, xy); as a stiffness it maps strain with engineering shear to stress.
using Matrix3 = SquareMatrix<3>;
/// Rows: stress (xx, yy, xy, yx), columns: displacement gradient h_ij = du_i/dx_j (xx, yy, xy, yx); neither is assumed
/// symmetric.
using Matrix4 = SquareMatrix<4>;

template <std::size_t N>
constexpr SquareMatrix<N> operator*(double factor, SquareMatrix<N> m) {
  for (auto& row : m) {
    for (double& entry : row) entry *= factor;
  }
  return m;
}

template <std::size_t N>
constexpr SquareMatrix<N> operator+(SquareMatrix<N> a, const SquareMatrix<N>& b) {
  for (std::size_t r = 0; r < N; ++r) {
    for (std::size_t c = 0; c < N; ++c) a[r][c] += b[r][c];
  }
  return a;
}

template <std::size_t N>
constexpr SquareMatrix<N> operator-(SquareMatrix<N> a, const SquareMatrix<N>& b) {
  return a + (-1.0) * b;
}

template <std::size_t N>
constexpr SquareMatrix<N> operator*(const SquareMatrix<N>& a, const SquareMatrix<N>& b) {
  SquareMatrix<N> result{};
  for (std::size_t r = 0; r < N; ++r) {
    for (std::size_t c = 0; c < N; ++c) {
      for (std::size_t k = 0; k < N; ++k) result[r][c] += a[r][k] * b[k][c];
    }
  }
  return result;
}

template <std::size_t N>
double largest_entry(const SquareMatrix<N>& m) {
  double largest = 0;
  for (const auto& row : m) {
    for (const double entry : row) largest = std::max(largest, std::abs(entry));
  }
  return largest;
}

}  // namespace equidem
