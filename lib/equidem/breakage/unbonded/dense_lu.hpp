// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Small dense systems by Gaussian elimination, with row pivots, or with full pivots where they may be singular.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

namespace equidem {

/// L U of a square matrix, row-major, in its place.
/// \return the least pivot over the largest entry of the matrix; 0: it is singular
inline double factorize_dense(std::span<double> a, std::vector<std::size_t>& pivots) {
  const auto n = static_cast<std::size_t>(std::lround(std::sqrt(static_cast<double>(a.size()))));
  pivots.resize(n);
  double largest = 0, least = 1;
  for (const double x : a) largest = std::max(largest, std::abs(x));
  for (std::size_t k = 0; k < n; ++k) {
    std::size_t p = k;
    for (std::size_t r = k + 1; r < n; ++r) {
      if (std::abs(a[r * n + k]) > std::abs(a[p * n + k])) p = r;
    }
    pivots[k] = p;
    const double pivot = a[p * n + k];
    if (!(std::abs(pivot) > 0)) return 0;
    least = std::min(least, std::abs(pivot) / largest);
    for (std::size_t c = 0; c < n && p != k; ++c) std::swap(a[k * n + c], a[p * n + c]);
    for (std::size_t r = k + 1; r < n; ++r) {
      const double factor = a[r * n + k] /= pivot;
      for (std::size_t c = k + 1; c < n && factor != 0; ++c) a[r * n + c] -= factor * a[k * n + c];
    }
  }
  return least;
}

inline void solve_dense(std::span<const double> lu, std::span<const std::size_t> pivots, std::span<double> x) {
  const std::size_t n = pivots.size();
  for (std::size_t k = 0; k < n; ++k) std::swap(x[k], x[pivots[k]]);
  for (std::size_t r = 0; r < n; ++r) {
    for (std::size_t c = 0; c < r; ++c) x[r] -= lu[r * n + c] * x[c];
  }
  for (std::size_t r = n; r-- > 0;) {
    for (std::size_t c = r + 1; c < n; ++c) x[r] -= lu[r * n + c] * x[c];
    x[r] /= lu[r * n + r];
  }
}

/// A x = b with a square A that may be singular: its rank, the least solution, and what it leaves free.
class FullPivots {
 public:
  explicit FullPivots(std::size_t n) : n_(n), a_(n * n, 0.0), b_(n, 0.0), order_(n) {
    for (std::size_t k = 0; k < n; ++k) order_[k] = k;
  }
  double& matrix(std::size_t row, std::size_t column) { return a_[row * n_ + column]; }
  double& right(std::size_t row) { return b_[row]; }

  /// \param zero pivots below are none
  /// \return the least pivot that is one; 1 where that is larger
  double eliminate(double zero) {
    double least = 1;
    for (; rank_ < n_; ++rank_) {
      std::size_t row = rank_, column = rank_;
      for (std::size_t r = rank_; r < n_; ++r) {
        for (std::size_t c = rank_; c < n_; ++c)
          if (std::abs(at(r, c)) > std::abs(at(row, column))) row = r, column = c;
      }
      if (!(std::abs(at(row, column)) > zero)) break;
      least = std::min(least, std::abs(at(row, column)));
      std::swap(order_[rank_], order_[column]);
      for (std::size_t c = 0; c < n_; ++c) std::swap(a_[rank_ * n_ + c], a_[row * n_ + c]);
      std::swap(b_[rank_], b_[row]);
      for (std::size_t r = 0; r < n_; ++r) {
        const double factor = at(r, rank_) / at(rank_, rank_);
        if (r == rank_ || factor == 0) continue;
        for (std::size_t c = rank_; c < n_; ++c) at(r, c) -= factor * at(rank_, c);
        b_[r] -= factor * b_[rank_];
      }
    }
    return least;
  }
  /// The largest component of b that no x gives.
  [[nodiscard]] double left() const {
    double most = 0;
    for (std::size_t r = rank_; r < n_; ++r) most = std::max(most, std::abs(b_[r]));
    return most;
  }
  /// Orthonormal x with A x = 0.
  [[nodiscard]] std::vector<std::vector<double>> free() const {
    std::vector<std::vector<double>> all;
    for (std::size_t c = rank_; c < n_; ++c) {
      std::vector<double> x(n_, 0.0);
      x[order_[c]] = 1;
      for (std::size_t r = 0; r < rank_; ++r) x[order_[r]] = -at(r, c) / at(r, r);
      for (int twice = 0; twice < 2; ++twice)
        for (const auto& other : all) remove(x, other);
      const double size = std::sqrt(dot(x, x));
      for (double& value : x) value /= size;
      all.push_back(std::move(x));
    }
    return all;
  }
  /// The shortest x with A x = b, but for left().
  [[nodiscard]] std::vector<double> least() const {
    std::vector<double> x(n_, 0.0);
    for (std::size_t r = 0; r < rank_; ++r) x[order_[r]] = b_[r] / at(r, r);
    for (const auto& other : free()) remove(x, other);
    return x;
  }

 private:
  // Columns in the order of pivots.
  double& at(std::size_t row, std::size_t column) { return a_[row * n_ + order_[column]]; }
  [[nodiscard]] double at(std::size_t row, std::size_t column) const { return a_[row * n_ + order_[column]]; }
  static double dot(const std::vector<double>& a, const std::vector<double>& b) {
    double sum = 0;
    for (std::size_t k = 0; k < a.size(); ++k) sum += a[k] * b[k];
    return sum;
  }
  static void remove(std::vector<double>& x, const std::vector<double>& unit) {
    const double by = dot(x, unit);
    for (std::size_t k = 0; k < x.size(); ++k) x[k] -= by * unit[k];
  }

  std::size_t n_, rank_ = 0;
  std::vector<double> a_, b_;
  std::vector<std::size_t> order_;
};

}  // namespace equidem
