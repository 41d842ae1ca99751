// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/breakage/unbonded/complementarity.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace equidem {
namespace {

constexpr double least_entry = 1e-9;  // of a column: smaller ones are round-off

/// The equations w - M z - d z_0 = q, d > 0, solved for the basic variables: columns of w, z, z_0, and the values.
class LemkeTableau {
 public:
  LemkeTableau(std::span<const double> m, std::span<const double> q)
      : n_(q.size()), width_(2 * n_ + 2), entries_(n_ * width_, 0.0), basic_(n_) {
    for (std::size_t r = 0; r < n_; ++r) {
      at(r, r) = 1;
      for (std::size_t c = 0; c < n_; ++c) at(r, n_ + c) = -m[r * n_ + c];
      // Different entries of d keep equal rows, of symmetric packings, from tying.
      at(r, 2 * n_) = -1 - 0.01 * std::fmod(0.618033988749895 * static_cast<double>(r + 1), 1.0);
      at(r, 2 * n_ + 1) = q[r];
      basic_[r] = r;
    }
  }

  bool solve() {
    std::size_t row = 0;
    double least = 0;
    for (std::size_t r = 0; r < n_; ++r) {
      const double ratio = value(r) / -at(r, 2 * n_);
      if (ratio < least) least = ratio, row = r;
    }
    if (least == 0) return true;
    const std::size_t most = 50 * n_ + 200;
    for (std::size_t k = 0, entering = 2 * n_; k < most; ++k) {
      const std::size_t leaving = basic_[row];
      pivot(row, entering);
      if (leaving == 2 * n_) return true;
      entering = leaving < n_ ? leaving + n_ : leaving - n_;
      const std::optional<std::size_t> next = blocking(entering);
      if (!next) return false;
      row = *next;
    }
    return false;
  }

  [[nodiscard]] std::vector<double> z() const {
    std::vector<double> z(n_, 0.0);
    for (std::size_t r = 0; r < n_; ++r) {
      if (basic_[r] >= n_ && basic_[r] < 2 * n_) z[basic_[r] - n_] = std::max(0.0, entries_[r * width_ + width_ - 1]);
    }
    return z;
  }

 private:
  double& at(std::size_t r, std::size_t c) { return entries_[r * width_ + c]; }
  double& value(std::size_t r) { return at(r, width_ - 1); }

  /// The basic variable that reaches 0 first; z_0 where it is among several.
  std::optional<std::size_t> blocking(std::size_t column) {
    std::optional<std::size_t> found;
    double best = 0;
    for (std::size_t r = 0; r < n_; ++r) {
      if (at(r, column) < least_entry) continue;
      const double ratio = value(r) / at(r, column);
      const bool tie = found && std::abs(ratio - best) <= 1e-12 * std::max(1.0, std::abs(best));
      if (found && !(tie ? basic_[r] == 2 * n_ : ratio < best)) continue;
      best = ratio;
      found = r;
    }
    return found;
  }

  void pivot(std::size_t row, std::size_t column) {
    const double by = 1 / at(row, column);
    for (std::size_t c = 0; c < width_; ++c) at(row, c) *= by;
    for (std::size_t r = 0; r < n_; ++r) {
      const double factor = at(r, column);
      if (r == row || factor == 0) continue;
      for (std::size_t c = 0; c < width_; ++c) at(r, c) -= factor * at(row, c);
    }
    basic_[row] = column;
  }

  std::size_t n_, width_;
  std::vector<double> entries_;
  std::vector<std::size_t> basic_;
};

}  // namespace

std::optional<std::vector<double>> solve_complementarity(std::span<const double> m, std::span<const double> q) {
  LemkeTableau tableau(m, q);
  if (!tableau.solve()) return {};
  return tableau.z();
}

}  // namespace equidem
