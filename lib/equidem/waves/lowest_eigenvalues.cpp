// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/waves/lowest_eigenvalues.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
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
    std::vector<std::size_t> open(x_);
    std::iota(open.begin(), open.end(), 0);
    values_.resize(x_), bounds_.resize(x_);
    Progress progress("natural frequencies");
    for (;; ++result.iterations) {
      evaluate();
      measure(open);
      std::vector<std::size_t> closed;
      for (std::size_t k = 0; k < options_.wanted; ++k) {
        if (std::ranges::find(open, k) == open.end()) closed.push_back(k);
      }
      if (all_converged()) measure(closed);  // anew, for they have changed
      result.converged = all_converged();
      if (result.converged || result.iterations == options_.iterations) break;
      progress.update(share_done());
      expand();
      if (!reduce()) break;
      open.clear();
      for (std::size_t k = 0; k < x_; ++k) {
        if (!converged(k)) open.push_back(k);
      }
    }
    result.values.assign(values_.begin(), values_.begin() + static_cast<std::ptrdiff_t>(options_.wanted));
    result.error_bounds.assign(bounds_.begin(), bounds_.begin() + static_cast<std::ptrdiff_t>(options_.wanted));
    result.vectors = TallMatrix(a_.size, options_.wanted);
    std::ranges::copy(s_.column(0, options_.wanted), result.vectors.column(0, options_.wanted).begin());
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

  [[nodiscard]] bool converged(std::size_t k) const { return bounds_[k] <= options_.tolerance * values_[k]; }
  [[nodiscard]] bool all_converged() const {
    for (std::size_t k = 0; k < options_.wanted; ++k) {
      if (!converged(k)) return false;
    }
    return true;
  }
  /// The share of the decades on the way to the tolerance that are done.
  [[nodiscard]] double share_done() const {
    double share = 1;
    for (std::size_t k = 0; k < options_.wanted; ++k) {
      share = std::min(share, std::log(bounds_[k] / values_[k]) / std::log(options_.tolerance));
    }
    return std::clamp(share, 0.0, 1.0);
  }

  /// A X anew, since its rounding would pile up, and the quotients of Rayleigh.
  void evaluate() {
    a_.multiply(s_, {0, x_}, as_);
    for (std::size_t k = 0; k < x_; ++k) values_[k] = dot_product(std::as_const(s_).column(k), as_.column(k));
  }

  /// Appends T r to W for the error_bounds r of columns of X. With A x = value x + r, |x| = 1,
  ///
  ///   r.A^-1 r = sum_j (lambda_j - value)²/lambda_j (x.x_j)² >= min_j (lambda_j - value)²/lambda_j,
  ///
  /// a bound that rounding of r, mostly in high eigenvectors, hardly touches. T is an approximation of A^-1.
  void measure(const std::vector<std::size_t>& columns) {
    constexpr double safety = 1.2;
    const ColumnRange w{x_ + p_ + w_, columns.size()};
    for (std::size_t c = 0; c < columns.size(); ++c) {
      const auto x = std::as_const(s_).column(columns[c]), ax = std::as_const(as_).column(columns[c]);
      const auto residual = s_.column(w.first + c);
      const double value = values_[columns[c]];
      parallel_ranges(a_.size, rows_of_sum, [&](std::size_t begin, std::size_t end) {
        for (std::size_t row = begin; row < end; ++row) residual[row] = ax[row] - value * x[row];
      });
    }
    make_orthogonal_to(null_, all_of_null(), s_, w);
    std::ranges::copy(s_.column(w.first, w.count), as_.column(w.first, w.count).begin());
    a_.precondition(s_, w);
    make_orthogonal_to(null_, all_of_null(), s_, w);
    for (std::size_t c = 0; c < columns.size(); ++c) {
      const double square = dot_product(std::as_const(s_).column(w.first + c), as_.column(w.first + c));
      bounds_[columns[c]] = safety * std::sqrt(std::max(0.0, square) * std::max(0.0, values_[columns[c]]));
    }
    w_ += w.count;
  }

  /// W orthonormal, and A W.
  void expand() {
    const std::size_t first = x_ + p_;
    for (int pass = 0; pass < 2; ++pass) {  // what was small beside X counts in the second
      make_orthogonal_to(s_, {0, first}, s_, {first, w_});
      w_ = make_orthonormal(s_, {first, w_});
    }
    a_.multiply(s_, {first, w_}, as_);
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
  std::size_t x_ = 0, p_ = 0, w_ = 0;    // columns of each
  std::vector<double> values_, bounds_;  // of X
};

}  // namespace

LowestEigenvalues lowest_eigenvalues(const SymmetricOperator& a, const TallMatrix& null, const LowestOptions& options) {
  return LowestBlock(a, null, options).run();
}

}  // namespace equidem
