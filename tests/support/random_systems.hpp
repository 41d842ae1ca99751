// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Symmetric matrices of random blocks on random graphs: nothing that comes from springs, so that factorizations meet
/// zero diagonals, pivots that grow and pivots that must wait.
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "equidem/core/random.hpp"
#include "equidem/linear/contact_graph.hpp"
#include "equidem/linear/multifrontal/front.hpp"
#include "equidem/linear/ordering/nested_dissection.hpp"
#include "equidem/linear/ordering/symbolic_factor.hpp"
#include "equidem/linear/stiffness_matrix.hpp"

#include "support/dense_oracle.hpp"

namespace equidem::test {

/// Discs at random points, each joined to its nearest neighbours and some to discs anywhere; pairs may repeat.
inline Assembly random_graph(int discs, int near, int far, Random& random) {
  Assembly assembly;
  for (int d = 0; d < discs; ++d) {
    assembly.centres.push_back({random.uniform(), random.uniform()});
    assembly.radii.push_back(1);
  }
  const auto join = [&](int i, int j) { assembly.contacts.push_back({i, j, 0, 0, 1, 1}); };
  for (int d = 0; d < discs; ++d) {
    std::vector<std::pair<double, int>> others;
    for (int e = 0; e < discs; ++e) {
      if (e != d) others.emplace_back(norm(assembly.centres[e] - assembly.centres[d]), e);
    }
    std::sort(others.begin(), others.end());
    for (int k = 0; k < std::min<int>(near, static_cast<int>(others.size())); ++k) join(d, others[k].second);
  }
  for (int k = 0; k < far; ++k) {
    const auto i = static_cast<int>(random.below(discs)), j = static_cast<int>(random.below(discs));
    if (i != j) join(i, j);
  }
  return assembly;
}

/// A matrix with everything that a factorization needs.
struct RandomSystem {
  Assembly assembly;
  ContactGraph graph;
  StiffnessMatrix matrix;
  std::shared_ptr<const SymbolicFactor> symbolic;

  RandomSystem(Assembly discs, int block, int leaf_size)
      : assembly(std::move(discs)),
        graph(assembly),
        symbolic(std::make_shared<const SymbolicFactor>(
            analyze(dissect(assembly, graph, {.leaf_size = leaf_size}), graph, block))) {
    matrix.block = block;
    matrix.diagonal.assign(assembly.size() * block * block, 0.0);
    matrix.coupling.assign(assembly.contacts.size() * block * block, 0.0);
  }

  [[nodiscard]] MatrixOnGraph on_graph() const { return {matrix, assembly, graph}; }
  [[nodiscard]] std::size_t unknowns() const { return assembly.size() * matrix.block; }
  [[nodiscard]] DenseMatrix dense_matrix() const { return test::dense_matrix(matrix, assembly); }

  /// Entries uniform in (-1, 1), but a share of the diagonal blocks zero.
  void fill_at_random(Random& random, double zero_share) {
    const auto b = static_cast<std::size_t>(matrix.block);
    for (double& entry : matrix.coupling) entry = random.uniform(-1, 1);
    for (std::size_t d = 0; d < assembly.size(); ++d) {
      const bool zero = random.uniform() < zero_share;
      double* at = &matrix.diagonal[d * b * b];
      for (std::size_t r = 0; r < b; ++r) {
        for (std::size_t c = 0; c <= r; ++c) at[r * b + c] = at[c * b + r] = zero ? 0 : random.uniform(-1, 1);
      }
    }
  }
  /// Diagonal blocks large enough for the matrix to be positive definite.
  void fill_positive(Random& random) {
    fill_at_random(random, 1);
    const auto b = static_cast<std::size_t>(matrix.block);
    for (std::size_t d = 0; d < assembly.size(); ++d) {
      const double rows = static_cast<double>(graph.of(d).size() * b) + random.uniform(0.1, 1);
      for (std::size_t r = 0; r < b; ++r) matrix.diagonal[(d * b + r) * b + r] = rows;
    }
  }
};

/// y = A x.
inline std::vector<double> times(const DenseMatrix& a, const std::vector<double>& x) {
  std::vector<double> y(a.size, 0.0);
  for (std::size_t r = 0; r < a.size; ++r) {
    for (std::size_t c = 0; c < a.size; ++c) y[r] += a(r, c) * x[c];
  }
  return y;
}

/// Largest row sum of |A|.
inline double norm_of(const DenseMatrix& a) {
  double norm = 0;
  for (std::size_t r = 0; r < a.size; ++r) {
    double sum = 0;
    for (std::size_t c = 0; c < a.size; ++c) sum += std::abs(a(r, c));
    norm = std::max(norm, sum);
  }
  return norm;
}

}  // namespace equidem::test
