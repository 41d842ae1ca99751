// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/linear/multigrid/block_matrix.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include "equidem/core/random.hpp"
#include "equidem/core/threads.hpp"

namespace equidem::multigrid {
namespace {

constexpr std::size_t rows_at_once = 1 << 12;

Quad load(const float* p) {
  Quad q;
  std::memcpy(&q, p, sizeof q);
  return q;
}

Quad times(const float* block, Quad x) {
  return load(block) * x[0] + load(block + 3) * x[1] + load(block + 6) * x[2];
}

Quad residual_of_row(const BlockMatrix& a, std::size_t row, const Quad* b, const Quad* x) {
  Quad sum = b[row];
  for (std::int64_t e = a.first[row]; e < a.first[row + 1]; ++e) sum -= times(&a.blocks[9 * e], x[a.columns[e]]);
  return sum;
}

}  // namespace

Block inverse_or_zero(const Block& block) {
  constexpr double nothing = 1e-6;  // share of a diagonal entry that rounding of the entries in float may leave
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

double BlockMatrix::bytes() const {
  return 8.0 * static_cast<double>(first.size()) + 4.0 * static_cast<double>(columns.size()) +
         4.0 * static_cast<double>(blocks.size() + inverse.size());
}

RowRange BlockMatrix::reach(RowRange rows) const {
  RowRange result = rows;
  for (std::int64_t e = first[rows.begin]; e < first[rows.end]; ++e) {
    const auto column = static_cast<std::size_t>(columns[e]);
    result = {std::min(result.begin, column), std::max(result.end, column + 1)};
  }
  return result;
}

void BlockMatrix::start(RowRange rows, float factor, const Quad* b, Quad* x) const {
  for (std::size_t row = rows.begin; row < rows.end; ++row) x[row] = factor * times(&inverse[9 * row], b[row]);
}

void BlockMatrix::advance(RowRange rows, const ChebyshevStep& step, const Quad* b, const Quad* x, Quad* next) const {
  for (std::size_t row = rows.begin; row < rows.end; ++row) {
    Quad change = step.add * times(&inverse[9 * row], residual_of_row(*this, row, b, x));
    if (step.keep != 0) change += step.keep * (step.from_zero ? x[row] : x[row] - next[row]);
    next[row] = x[row] + change;
  }
}

void BlockMatrix::residual(RowRange rows, const Quad* b, const Quad* x, Quad* r) const {
  for (std::size_t row = rows.begin; row < rows.end; ++row) r[row] = residual_of_row(*this, row, b, x);
}

double largest_eigenvalue(const BlockMatrix& a, int iterations) {
  const std::size_t n = a.rows();
  QuadVector zero(n), x(n), product(n);
  Random random(1);
  for (std::size_t row = 0; row < n; ++row) {
    const auto number = [&] { return static_cast<float>(random.uniform() - 0.5); };
    zero[row] = Quad{};
    x[row] = Quad{number(), number(), number(), 0};
  }
  double value = 0;
  for (int k = 0; k < iterations; ++k) {
    parallel_ranges(n, rows_at_once, [&](std::size_t begin, std::size_t end) {
      for (std::size_t row = begin; row < end; ++row) {
        product[row] = times(&a.inverse[9 * row], residual_of_row(a, row, zero.data(), x.data()));
      }
    });
    double before = 0, after = 0;
    for (std::size_t row = 0; row < n; ++row) {
      for (int c = 0; c < 3; ++c) {
        before += static_cast<double>(x[row][c]) * x[row][c];
        after += static_cast<double>(product[row][c]) * product[row][c];
      }
    }
    if (!(before > 0 && after > 0)) return value;
    value = std::sqrt(after / before);
    const auto scale = static_cast<float>(1 / std::sqrt(after));
    for (std::size_t row = 0; row < n; ++row) x[row] = scale * product[row];
  }
  return value;
}

}  // namespace equidem::multigrid
