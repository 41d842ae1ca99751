// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Dense linear algebra as plain as it gets, for small systems that solvers are compared with.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <utility>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/linear/stiffness_matrix.hpp"

namespace equidem::test {

/// A square matrix, row by row.
struct DenseMatrix {
  std::size_t size = 0;
  std::vector<double> entries;

  explicit DenseMatrix(std::size_t n) : size(n), entries(n * n, 0.0) {}
  double& operator()(std::size_t r, std::size_t c) { return entries[r * size + c]; }
  double operator()(std::size_t r, std::size_t c) const { return entries[r * size + c]; }
};

/// All entries of K over discs x block components, held ones included.
inline DenseMatrix dense_matrix(const StiffnessMatrix& matrix, const Assembly& assembly) {
  const auto b = static_cast<std::size_t>(matrix.block);
  DenseMatrix k(assembly.size() * b);
  for (std::size_t r = 0; r < b; ++r) {
    for (std::size_t c = 0; c < b; ++c) {
      for (std::size_t d = 0; d < assembly.size(); ++d) {
        k(d * b + r, d * b + c) += matrix.diagonal_block(d)[r * b + c];
      }
      for (std::size_t e = 0; e < assembly.contacts.size(); ++e) {
        const auto i = static_cast<std::size_t>(assembly.contacts[e].i);
        const auto j = static_cast<std::size_t>(assembly.contacts[e].j);
        k(i * b + r, j * b + c) += matrix.coupling_block(e)[r * b + c];
        k(j * b + c, i * b + r) += matrix.coupling_block(e)[r * b + c];
      }
    }
  }
  return k;
}

/// A^-1 b by Gauss's elimination with partial pivoting.
inline std::vector<double> solve(DenseMatrix a, std::vector<double> b) {
  for (std::size_t p = 0; p < a.size; ++p) {
    std::size_t best = p;
    for (std::size_t r = p + 1; r < a.size; ++r) {
      if (std::abs(a(r, p)) > std::abs(a(best, p))) best = r;
    }
    if (a(best, p) == 0) throw std::domain_error("the dense matrix is singular");
    for (std::size_t c = p; c < a.size; ++c) std::swap(a(p, c), a(best, c));
    std::swap(b[p], b[best]);
    for (std::size_t r = p + 1; r < a.size; ++r) {
      const double l = a(r, p) / a(p, p);
      for (std::size_t c = p; c < a.size; ++c) a(r, c) -= l * a(p, c);
      b[r] -= l * b[p];
    }
  }
  for (std::size_t p = a.size; p-- > 0;) {
    for (std::size_t c = p + 1; c < a.size; ++c) b[p] -= a(p, c) * b[c];
    b[p] /= a(p, p);
  }
  return b;
}

/// Largest |x - y| over largest |y|.
inline double relative_difference(const std::vector<double>& x, const std::vector<double>& y) {
  double difference = 0, size = 0;
  for (std::size_t k = 0; k < y.size(); ++k) {
    difference = std::max(difference, std::abs(x.at(k) - y[k]));
    size = std::max(size, std::abs(y[k]));
  }
  return difference / size;
}

}  // namespace equidem::test
