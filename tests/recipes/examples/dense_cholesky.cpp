// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <vector>

#include "equidem/linear/linear_solver.hpp"
#include "equidem/linear/multifrontal/front.hpp"
#include "equidem/linear/stiffness_matrix.hpp"

namespace equidem {
namespace {

/// K = L L^T over the free components, L stored row by row.
class DenseCholesky final : public Factorization {
 public:
  explicit DenseCholesky(std::vector<std::int64_t> components) : components_(std::move(components)) {
    report_.name = "dense Cholesky";
  }

  bool factorize(const CompressedColumns& lower) {
    const std::size_t n = components_.size();
    l_.assign(n * n, 0.0);
    for (std::size_t c = 0; c < n; ++c)
      for (auto e = lower.first[c]; e < lower.first[c + 1]; ++e)
        l_[static_cast<std::size_t>(lower.rows[e]) * n + c] = lower.values[e];
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t j = 0; j <= i; ++j) {
        double sum = l_[i * n + j];
        for (std::size_t k = 0; k < j; ++k) sum -= l_[i * n + k] * l_[j * n + k];
        if (i == j && !(sum > 0)) return false;
        l_[i * n + j] = i == j ? std::sqrt(sum) : sum / l_[j * n + j];
      }
    }
    return true;
  }

  void solve(std::span<double> x, int right_hand_sides) override {
    const std::size_t n = components_.size(), stride = x.size() / static_cast<std::size_t>(right_hand_sides);
    for (std::size_t column = 0; column < x.size(); column += stride) {
      std::vector<double> y(n);
      for (std::size_t i = 0; i < n; ++i) {
        y[i] = x[column + static_cast<std::size_t>(components_[i])];
        for (std::size_t k = 0; k < i; ++k) y[i] -= l_[i * n + k] * y[k];
        y[i] /= l_[i * n + i];
      }
      for (std::size_t i = n; i-- > 0;) {
        for (std::size_t k = i + 1; k < n; ++k) y[i] -= l_[k * n + i] * y[k];
        y[i] /= l_[i * n + i];
        x[column + static_cast<std::size_t>(components_[i])] = y[i];
      }
    }
  }

  [[nodiscard]] const FactorReport& report() const override { return report_; }

 private:
  std::vector<std::int64_t> components_;
  std::vector<double> l_;
  FactorReport report_;
};

}  // namespace

std::unique_ptr<Factorization> factorize_by_dense(const MatrixOnGraph& matrix, const DegreesOfFreedom& unknowns,
                                                  const SymbolicFactor&, const SolverOptions&) {
  const CompressedColumns lower = compress(matrix.matrix, matrix.assembly, matrix.graph, unknowns);
  auto factor = std::make_unique<DenseCholesky>(lower.component);
  if (!factor->factorize(lower)) return nullptr;
  return factor;
}

}  // namespace equidem
