// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Multifrontal Cholesky factorization on the dissection tree of the discs.
/// Multifrontal L D L^T factorization of an indefinite matrix on the dissection tree of the discs.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "equidem/linear/factorization.hpp"
#include "equidem/linear/kernels/panel_solve.hpp"
#include "equidem/linear/large_buffer.hpp"
#include "equidem/linear/multifrontal/front.hpp"
#include "equidem/linear/multifrontal/tree_sweep.hpp"
#include "equidem/linear/ordering/symbolic_factor.hpp"
#include "equidem/linear/stiffness_matrix.hpp"

namespace equidem {

/// K = L L^T (multifrontal_cholesky.hpp).
class CholeskyFactor final : public Factorization {
 public:
  /// Memory for the panels, which hold nothing yet.
  explicit CholeskyFactor(std::shared_ptr<const SymbolicFactor> symbolic);

  /// Whether all pivots are positive. It can be called again, for another matrix on the same graph.
  bool factorize(const MatrixOnGraph& k);

  void solve(std::span<double> x, int right_hand_sides) override;
  [[nodiscard]] std::optional<std::vector<double>> softest_motion() const override;
  [[nodiscard]] const FactorReport& report() const override { return report_; }

  /// Right-hand sides in the order of elimination, one after another.
  struct Columns {
    double* data;
    std::size_t size;
    std::size_t count;  ///< <= most_columns
  };
  /// L y = b.
  void forward(const Columns& y) const;
  /// L^T x = y on front t, where what stands above it is done: x_own := L_11^-T (y_own - L_21^T x_rows).
  void backward(std::size_t t, const Columns& y) const;
  /// Likewise on all fronts.
  void backward(const Columns& y) const;
  /// The columns of front t, column-major: rows of its own unknowns, then those that it updates.
  [[nodiscard]] double* panel(std::size_t t) { return panels_.data() + offset_[t]; }
  [[nodiscard]] Panel panel(std::size_t t) const {
    return {panels_.data() + offset_[t], symbolic_->pivots(t), symbolic_->pivots(t) + symbolic_->updates(t)};
  }
  [[nodiscard]] const SymbolicFactor& symbolic() const { return *symbolic_; }

 private:
  using Sweep = TreeSweep;

  std::shared_ptr<const SymbolicFactor> symbolic_;
  Sweep solve_sweep_;
  ForwardSweep forward_sweep_;
  std::vector<std::size_t> offset_;  // of the panel of each front
  LargeVector<double> panels_;
  FactorReport report_;
};

/// K = L L^T (Duff & Reid 1983), subtrees on separate threads, large fronts in tiles; the same bits for every number
/// of threads. Returns a null pointer where K is not positive definite to working precision.
std::unique_ptr<Factorization> multifrontal_cholesky(std::shared_ptr<const SymbolicFactor> symbolic,
                                                     const MatrixOnGraph& matrix);

struct IndefiniteOptions {
  double threshold = 0.01;  ///< u: |L_ij| <= 1/u; larger is safer and delays more pivots
};

/// P K P^T = L D L^T with 1 x 1 and 2 x 2 pivots. Pivots that would grow
/// are delayed to the parent front, so that the factorization is as stable as a dense one with threshold pivoting.
/// The signs of D are the inertia of K. Unknowns that no front could eliminate count as zero_pivots: K is singular.
std::unique_ptr<Factorization> multifrontal_ldlt(std::shared_ptr<const SymbolicFactor> symbolic,
                                                 const MatrixOnGraph& matrix, const IndefiniteOptions& options = {});

}  // namespace equidem
