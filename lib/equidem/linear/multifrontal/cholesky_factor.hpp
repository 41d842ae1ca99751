// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A Cholesky factor as panels of columns, one for each front.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <type_traits>
#include <vector>

#include "equidem/linear/factorization.hpp"
#include "equidem/linear/kernels/panel_solve.hpp"
#include "equidem/linear/large_buffer.hpp"
#include "equidem/linear/multifrontal/forward_sweep.hpp"
#include "equidem/linear/multifrontal/front.hpp"
#include "equidem/linear/multifrontal/tree_sweep.hpp"
#include "equidem/linear/ordering/symbolic_factor.hpp"

namespace equidem {

/// K = L L^T; with Real = float that of S K S (multifrontal_cholesky.hpp). There for float and double.
template <typename Real>
class CholeskyFactor final : public Factorization {
 public:
  /// Memory for the panels, which hold nothing yet.
  explicit CholeskyFactor(std::shared_ptr<const SymbolicFactor> symbolic);

  /// Whether all pivots are positive. It can be called again, for another matrix on the same graph.
  bool factorize(const MatrixOnGraph& k);

  void solve(std::span<double> x, int right_hand_sides) const override;
  [[nodiscard]] std::vector<double> softest_motion() const override;
  [[nodiscard]] const FactorReport& report() const override { return report_; }

  /// Right-hand sides in the order of elimination, one after another.
  struct Columns {
    Real* data;
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
  [[nodiscard]] Real* panel(std::size_t t) { return panels_.data() + offset_[t]; }
  [[nodiscard]] Panel<Real> panel(std::size_t t) const {
    return {panels_.data() + offset_[t], symbolic_->pivots(t), symbolic_->pivots(t) + symbolic_->updates(t)};
  }
  [[nodiscard]] const SymbolicFactor& symbolic() const { return *symbolic_; }

 private:
  using Sweep = TreeSweep<Real>;
  static constexpr bool single = std::is_same_v<Real, float>;

  void choose_scale(const StiffnessMatrix& matrix);
  /// x := factor S x.
  void multiply_by_scale(std::span<double> x, double factor) const;
  /// x := S x over its largest component, which is returned.
  double scale_to_one(std::span<double> x) const;

  std::shared_ptr<const SymbolicFactor> symbolic_;
  Sweep solve_sweep_;
  ForwardSweep<Real> forward_sweep_;
  std::vector<std::size_t> offset_;  // of the panel of each front
  LargeVector<Real> panels_;
  std::vector<double> scale_;  // S in single precision, per component; else empty
  FactorReport report_;
};

}  // namespace equidem
