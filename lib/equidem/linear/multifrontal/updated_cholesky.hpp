// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A multifrontal Cholesky factor that follows changes of single springs along one path of the elimination tree.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "equidem/linear/kernels/panel_change.hpp"
#include "equidem/linear/multifrontal/multifrontal_cholesky.hpp"

namespace equidem {

/// K += c v v^T, with v over the components (u_x, u_y[, a theta]) of two discs: one spring of a contact, or, with
/// j = i, the support of a single disc.
struct RankOneChange {
  double stiffness = 0;  ///< c, Pa; negative: a spring is taken out
  std::int32_t i = 0, j = 0;
  std::array<double, 3> at_i{}, at_j{};  ///< v; at_j is added to at_i where j = i
};

/// The fronts from that of a contact up to its root, with what a change found and solved on them.
struct FactorPath {
  std::vector<std::int32_t> fronts;  ///< children first
  /// L^-1 f for the loads f: front by front, of each load the unknowns that the front eliminates.
  std::vector<double> values;
  /// Components (disc * block + k) in which nothing was left of a pivot but round-off: the new K is singular there, and
  /// their stiffness was added to it.
  std::vector<std::int64_t> held;
  double share = 1;  ///< determinant of the new K over that of the old one, without the pivots that are held
};

/// K = L L^T with vectors and factors in double precision. A rank-one change K + c v v^T of one contact alters the
/// columns of the fronts from that which eliminates its first disc up to the root, and no others (Davis & Hager 1999);
/// panels stay dense.
class UpdatedCholesky {
 public:
  explicit UpdatedCholesky(std::shared_ptr<const SymbolicFactor> symbolic);

  /// A factor of the whole matrix. The first call also sets the stiffness of each component by which pivots count as
  /// zero. \return whether K is positive definite beyond round-off
  [[nodiscard]] bool factorize(const MatrixOnGraph& k);

  /// Load on the two discs of a change, N/m.
  struct Load {
    std::array<double, 3> at_i{}, at_j{};
  };
  /// Changes of one contact, at most most_changes, and loads on its discs, at most most_right_sides, for which L y = f
  /// is solved with the new factor. Stiffness that is added is added first.
  FactorPath change(std::span<const RankOneChange> changes, std::span<const Load> loads = {});

  void solve(std::span<double> x, int right_hand_sides) { factor_.solve(x, right_hand_sides); }
  [[nodiscard]] const FactorReport& report() const { return factor_.report(); }
  using Columns = CholeskyFactor::Columns;
  void forward(const Columns& y) const { factor_.forward(y); }
  void backward(const Columns& y) const { factor_.backward(y); }
  /// The stiffness that is added to a pivot that vanishes, Pa.
  [[nodiscard]] double stiffness_of(std::int64_t component) const;

  /// Share of its stiffness below which a pivot counts as zero: round-off of thousands of changes leaves less, a
  /// cantilever of a thousand discs more.
  static constexpr double least_pivot = 1e-11;

 private:
  [[nodiscard]] const SymbolicFactor& symbolic() const { return factor_.symbolic(); }
  /// The front that eliminates the first of two discs, and those above it.
  [[nodiscard]] std::vector<std::int32_t> path_of(std::int32_t i, std::int32_t j) const;

  CholeskyFactor factor_;
  std::vector<std::int32_t> front_of_;  // of each disc, by its position in the order of elimination
  std::vector<double> stiffness_;       // diagonal of the first K, in the order of elimination
};

}  // namespace equidem
