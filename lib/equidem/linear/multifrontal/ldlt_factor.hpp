// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// L D L^T of a symmetric matrix on the dissection tree of the discs, for real and for complex numbers.
#pragma once

#include <complex>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "equidem/linear/factorization.hpp"
#include "equidem/linear/large_buffer.hpp"
#include "equidem/linear/multifrontal/indefinite_front.hpp"
#include "equidem/linear/multifrontal/tree_sweep.hpp"
#include "equidem/linear/ordering/symbolic_factor.hpp"
#include "equidem/linear/stiffness_matrix.hpp"

namespace equidem {

struct IndefiniteOptions {
  double threshold = 0.01;  ///< u: |L_ij| <= 1/u; larger is safer and delays more pivots
};

/// P K P^T = L D L^T with 1 x 1 and 2 x 2 pivots, without conjugation where numbers are complex. Pivots that would grow
/// are delayed to the parent front, so that the factorization is as stable as a dense one with threshold pivoting.
/// Unknowns that no front could eliminate count as zero_pivots: K is singular. There for double and
/// std::complex<double>.
template <typename Number>
class LdltFactor {
 public:
  LdltFactor(std::shared_ptr<const SymbolicFactor> symbolic, const MatrixOnGraphOf<Number>& k,
             const IndefiniteOptions& options);

  /// x := K^-1 x for right-hand sides stored one after another, in the order of discs.
  void solve(std::span<Number> x, int right_hand_sides) const;
  /// L^-T e of the unit vector of the smallest pivot; 0 where there is none.
  [[nodiscard]] std::vector<Number> softest_motion() const { return motion_of(softest_); }
  /// The k-th of FactorReport::zero_pivots zero-energy modes.
  [[nodiscard]] std::vector<Number> null_motion(std::int64_t k) const { return motion_of(null_.at(k)); }
  [[nodiscard]] std::vector<std::size_t> null_components() const;
  /// Complex numbers have no sign: negative_pivots is -1 for them.
  [[nodiscard]] const FactorReport& report() const { return report_; }

 private:
  using Pivots = FrontPivotsOf<Number>;
  using Front = IndefiniteFrontOf<Number>;
  using Sweep = TreeSweep<Number>;
  using Children = std::vector<typename Sweep::Child>;

  /// The factor of a front: its pivots with their part of L, and the rows that they update.
  struct FrontFactor {
    Pivots pivots;
    /// Unknowns in the order of elimination: pivots first, then delayed ones, then later rows.
    std::vector<std::int64_t> ids;
    LargeVector<Number> lower;  ///< ids.size() x pivots.count, column-major
    std::size_t delayed = 0;
  };

  [[nodiscard]] std::size_t unknowns() const { return symbolic_->position.size() * symbolic_->block; }
  [[nodiscard]] std::vector<Number> motion_of(std::int64_t unknown) const;
  void choose_scales(const MatrixOnGraphOf<Number>& k);
  void factorize(const MatrixOnGraphOf<Number>& k);
  void factorize_front_of(std::size_t t, const MatrixOnGraphOf<Number>& k, const Children& children,
                          std::vector<LargeVector<Number>>& updates);
  void scale_columns(Front& front, std::size_t own, std::size_t delayed) const;
  void scale(std::vector<Number>& y) const;
  static void make_room(Front& front, std::size_t own, std::size_t delayed);
  void add_child(std::size_t child, const LargeVector<Number>& update, const std::vector<std::int32_t>& index,
                 Front& front) const;
  void keep(const Front& front, FrontFactor& factor, LargeVector<Number>& update);
  void write_report();
  void forward(std::vector<Number>& y) const;
  static void divide_by_d(const FrontFactor& f, std::vector<Number>& y);
  void backward(std::vector<Number>& y) const;
  [[nodiscard]] double solve_work(std::size_t t) const;

  std::shared_ptr<const SymbolicFactor> symbolic_;
  IndefiniteOptions options_;
  std::vector<double> scale_;  // by row, in the order of elimination
  std::vector<FrontFactor> fronts_;
  BufferPool<Number> pool_;
  FactorReport report_;
  std::int64_t softest_ = -1;       // unknown of the smallest pivot
  std::vector<std::int64_t> null_;  // unknowns that nothing holds
};

}  // namespace equidem
