// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/waves/lowest_eigenvalues.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "equidem/core/ordered_sums.hpp"
#include "equidem/core/progress.hpp"
#include "equidem/core/random.hpp"
#include "equidem/core/threads.hpp"
#include "equidem/linear/multifrontal/dense_kernels.hpp"

namespace equidem {
namespace {

constexpr std::size_t rows_of_sum = 1 << 13;

double dot_product(std::span<const double> x, std::span<const double> y) {
  return sums_over<1>(x.size(), rows_of_sum, [&](std::size_t begin, std::size_t end) {
    double sum = 0;
    for (std::size_t k = begin; k < end; ++k) sum += x[k] * y[k];
    return std::array{sum};
  })[0];
}

/// Columns of the basis S = [X P W] and of A S.
class LowestBlock {
 public:
  LowestBlock(const SymmetricOperator& a, const TallMatrix& null, const LowestOptions& options)
      : a_(a),
        null_(null),
        options_(options),
        width_(options.wanted + options.guards),
        s_(a.size, 3 * width_),
        as_(a.size, 3 * width_) {}

  LowestEigenvalues run() {
    LowestEigenvalues result;
    if (!start()) return result;
    Progress progress("natural frequencies");
    for (;; ++result.iterations) {
      const std::vector<std::size_t> open = evaluate(result);
      if (result.converged || result.iterations == options_.iterations) break;
      double share = 1;  // of the decades on the way to the tolerance
      for (std::size_t k = 0; k < result.values.size(); ++k) {
        share = std::min(share, std::log(result.residuals[k] / result.values[k]) / std::log(options_.tolerance));
      }
      progress.update(std::clamp(share, 0.0, 1.0));
      expand(open);
      if (!reduce()) break;
    }
    TallMatrix vectors(a_.size, result.values.size());
    std::ranges::copy(s_.column(0, vectors.columns()), vectors.column(0, vectors.columns()).begin());
    result.vectors = std::move(vectors);
    return result;
  }

 private:
  [[nodiscard]] ColumnRange all_of_null() const { return {0, null_.columns()}; }

  /// X from T times random vectors.
  bool start() {
    Random random(options_.seed);
    const ColumnRange columns{0, width_};
    for (double& value : s_.column(0, width_)) value = random.uniform(-1, 1);
    make_orthogonal_to(null_, all_of_null(), s_, columns);
    a_.precondition(s_, columns);
    make_orthogonal_to(null_, all_of_null(), s_, columns);
    x_ = make_orthonormal(s_, columns);
    a_.multiply(s_, {0, x_}, as_);
    return x_ >= options_.wanted && reduce();
  }

  /// Values and residuals of X, which are written into the place of W; \returns those that have not converged.
  std::vector<std::size_t> evaluate(LowestEigenvalues& result) {
    a_.multiply(s_, {0, x_}, as_);  // anew: rounding of A X would pile up
    std::vector<std::size_t> open;
    result.values.clear();
    result.residuals.clear();
    result.converged = true;
    for (std::size_t k = 0; k < x_; ++k) {
      const auto x = std::as_const(s_).column(k), ax = std::as_const(as_).column(k);
      const double value = dot_product(x, ax);
      const auto residual = s_.column(x_ + p_ + open.size());
      parallel_ranges(a_.size, rows_of_sum, [&](std::size_t begin, std::size_t end) {
        for (std::size_t row = begin; row < end; ++row) residual[row] = ax[row] - value * x[row];
      });
      const double size = std::sqrt(dot_product(residual, residual));
      const bool done = size <= options_.tolerance * value;
      if (!done) open.push_back(k);
      if (k >= options_.wanted) continue;
      result.values.push_back(value);
      result.residuals.push_back(size);
      result.converged = result.converged && done;
    }
    return open;
  }

  void expand(const std::vector<std::size_t>& open) {
    const ColumnRange w{x_ + p_, open.size()};
    make_orthogonal_to(null_, all_of_null(), s_, w);
    a_.precondition(s_, w);
    make_orthogonal_to(null_, all_of_null(), s_, w);
    make_orthogonal_to(s_, {0, x_ + p_}, s_, w);
    w_ = make_orthonormal(s_, w);
    make_orthogonal_to(s_, {0, x_ + p_}, s_, {w.first, w_});  // what was small beside X counts now
    w_ = make_orthonormal(s_, {w.first, w_});
    a_.multiply(s_, {w.first, w_}, as_);
  }

  /// Rayleigh-Ritz: the lowest vectors of the basis become X, and their parts outside the X before become P.
  bool reduce() {
    const std::size_t all = x_ + p_ + w_;
    TallMatrix k = product_transposed(s_, {0, all}, as_, {0, all});
    for (std::size_t c = 0; c < all; ++c) {
      for (std::size_t r = c; r < all; ++r) k(r, c) = k(c, r) = 0.5 * (k(r, c) + k(c, r));
    }
    std::vector<double> values(all);
    if (dense::find_spectrum(all, &k(0, 0), values.data(), true) != 0) return false;
    TallMatrix turn(all, 2 * x_);
    std::ranges::copy(std::as_const(k).column(0, x_), turn.column(0, x_).begin());
    std::size_t of_p = 0;
    if (all > x_) {
      const ColumnRange p{x_, x_};
      std::ranges::copy(std::as_const(k).column(0, x_), turn.column(x_, x_).begin());
      for (std::size_t c = x_; c < 2 * x_; ++c) std::fill_n(&turn(0, c), x_, 0.0);
      make_orthogonal_to(turn, {0, x_}, turn, p);
      of_p = make_orthonormal(turn, p);
      make_orthogonal_to(turn, {0, x_}, turn, {x_, of_p});
      of_p = make_orthonormal(turn, {x_, of_p});
    }
    TallMatrix kept(all, x_ + of_p);
    std::ranges::copy(std::as_const(turn).column(0, x_ + of_p), kept.column(0, x_ + of_p).begin());
    combine(s_, {0, all}, kept);
    combine(as_, {0, all}, kept);
    p_ = of_p;
    w_ = 0;
    return true;
  }

  const SymmetricOperator& a_;
  const TallMatrix& null_;
  const LowestOptions& options_;
  std::size_t width_;
  TallMatrix s_, as_;
  std::size_t x_ = 0, p_ = 0, w_ = 0;  // columns of each
};

}  // namespace

LowestEigenvalues lowest_eigenvalues(const SymmetricOperator& a, const TallMatrix& null, const LowestOptions& options) {
  return LowestBlock(a, null, options).run();
}

}  // namespace equidem
