// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/linear/multigrid/block_matrix.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace equidem::multigrid {
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

}  // namespace equidem::multigrid
