// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/linear/multigrid/block_matrix.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

namespace equidem::multigrid {

std::vector<ChebyshevStep> chebyshev_steps(int degree, double largest, double range, bool from_zero) {
  const double middle = 0.5 * (largest + largest / range), half = 0.5 * (largest - largest / range);
  double rho = half / middle;
  std::vector<ChebyshevStep> steps{{.keep = 0, .add = static_cast<float>(1 / middle), .from_zero = from_zero}};
  for (int k = 1; k < degree; ++k) {
    const double following = 1 / (2 * middle / half - rho);
    steps.push_back({.keep = static_cast<float>(following * rho),
                     .add = static_cast<float>(2 * following / half),
                     .from_zero = from_zero && k == 1});
    rho = following;
  }
  return steps;
}

namespace {

constexpr double nothing = 1e-6;  // share of a diagonal entry that rounding of the entries in float may leave

/// By L D L^T, where no component is a combination of those before it.
std::optional<Block> regular_inverse(const Block& a) {
  if (!(a[0] > 0)) return {};
  const double d0 = 1 / a[0], l10 = a[3] * d0, l20 = a[6] * d0;
  const double pivot1 = a[4] - l10 * a[3];
  if (!(pivot1 > nothing * a[4])) return {};
  const double d1 = 1 / pivot1, l21 = (a[7] - l20 * a[3]) * d1;
  const double pivot2 = a[8] - l20 * a[6] - l21 * l21 * pivot1;
  if (!(pivot2 > nothing * a[8])) return {};
  const double d2 = 1 / pivot2, up = l10 * l21 - l20;
  const double xy = -l10 * d1 - up * l21 * d2, xt = up * d2, yt = -l21 * d2;
  return Block{d0 + l10 * l10 * d1 + up * up * d2, xy, xt, xy, d1 + l21 * l21 * d2, yt, xt, yt, d2};
}

}  // namespace

Block inverse_or_zero(const Block& block) {
  if (const auto inverse = regular_inverse(block)) return *inverse;
  std::array<int, 3> kept{};
  int count = 0;
  double l[3][3] = {};  // Cholesky factor of the rows kept
  for (int r = 0; r < 3; ++r) {
    double row[3] = {};
    double pivot = block[r * 4];
    for (int c = 0; c < count; ++c) {
      row[c] = block[r * 3 + kept[c]];
      for (int k = 0; k < c; ++k) row[c] -= row[k] * l[c][k];
      row[c] /= l[c][c];
      pivot -= row[c] * row[c];
    }
    if (!(pivot > nothing * block[r * 4])) continue;
    row[count] = std::sqrt(pivot);
    std::copy(row, row + 3, l[count]);
    kept[count++] = r;
  }
  Block result{};
  for (int c = 0; c < count; ++c) {
    double x[3] = {};
    x[c] = 1;
    for (int r = 0; r < count; ++r) {
      for (int k = 0; k < r; ++k) x[r] -= l[r][k] * x[k];
      x[r] /= l[r][r];
    }
    for (int r = count; r-- > 0;) {
      for (int k = r + 1; k < count; ++k) x[r] -= l[k][r] * x[k];
      x[r] /= l[r][r];
    }
    for (int r = 0; r < count; ++r) result[kept[r] * 3 + kept[c]] = x[r];
  }
  return result;
}

void BlockMatrix::resize() {
  columns.resize(first.back());
  blocks.resize(9 * first.back() + 1);
  inverse.resize(9 * rows() + 1);
  blocks.back() = inverse.back() = 0;
}

void BlockMatrix::set(std::int64_t entry, std::size_t column, const Block& block) {
  columns[entry] = static_cast<std::int32_t>(column);
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) blocks[9 * entry + 3 * c + r] = static_cast<float>(block[3 * r + c]);
  }
}

void BlockMatrix::set_inverse(std::size_t row, const Block& diagonal) {
  const Block value = inverse_or_zero(diagonal);
  std::copy(value.begin(), value.end(), &inverse[9 * row]);  // symmetric
}

EnvelopeCholesky::EnvelopeCholesky(const BlockMatrix& matrix) {
  const std::size_t n = 3 * matrix.rows();
  first_.resize(n);
  start_.resize(n);
  std::size_t total = 0;
  for (std::size_t r = 0; r < n; ++r) {
    std::size_t least = r / 3;
    for (std::int64_t e = matrix.first[r / 3]; e < matrix.first[r / 3 + 1]; ++e) {
      least = std::min(least, static_cast<std::size_t>(matrix.columns[e]));
    }
    first_[r] = 3 * least;
    start_[r] = total;
    total += r + 1 - first_[r];
  }
  values_.assign(total, 0.0);
  for (std::size_t r = 0; r < n; ++r) {
    double* to = &values_[start_[r]] - first_[r];
    for (std::int64_t e = matrix.first[r / 3]; e < matrix.first[r / 3 + 1]; ++e) {
      for (std::size_t c = 0; c < 3; ++c) {
        const std::size_t column = 3 * static_cast<std::size_t>(matrix.columns[e]) + c;
        if (column <= r) to[column] += matrix.blocks[9 * e + 3 * c + r % 3];
      }
    }
  }
  constexpr double nothing = 1e-6;  // share of a diagonal entry: rounding of the entries in float
  for (std::size_t r = 0; r < n; ++r) {
    double* to = &values_[start_[r]] - first_[r];
    double pivot = to[r];
    for (std::size_t c = first_[r]; c < r; ++c) {
      const double* other = row(c);
      const std::size_t begin = std::max(first_[r], first_[c]);
      to[c] = (to[c] - std::inner_product(to + begin, to + c, other + begin, 0.0)) * other[c];
      pivot -= to[c] * to[c];
    }
    to[r] = pivot > nothing * to[r] ? 1 / std::sqrt(pivot) : 0;
  }
}

void EnvelopeCholesky::solve(const QuadVector& b, QuadVector& x) const {
  const std::size_t n = first_.size();
  std::vector<double> y(n);
  for (std::size_t r = 0; r < n; ++r) {
    const double* l = row(r);
    y[r] = (b[r / 3][r % 3] - std::inner_product(l + first_[r], l + r, y.begin() + first_[r], 0.0)) * l[r];
  }
  for (std::size_t r = n; r-- > 0;) {
    const double* l = row(r);
    y[r] *= l[r];
    for (std::size_t c = first_[r]; c < r; ++c) y[c] -= l[c] * y[r];
  }
  for (std::size_t r = 0; r < n; ++r) x[r / 3][r % 3] = static_cast<float>(y[r]);
}

}  // namespace equidem::multigrid
