// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/linear/multifrontal/front.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "equidem/core/threads.hpp"
#include "equidem/linear/multifrontal/dense_kernels.hpp"

namespace equidem {

namespace front_tiles {

constexpr std::size_t tile = 256;

struct Tile {
  std::size_t row, column, rows, columns;
};

/// Tiles of the lower triangle of an n x n matrix, row by row.
inline std::vector<Tile> lower_tiles(std::size_t n) {
  std::vector<Tile> tiles;
  for (std::size_t r = 0; r < n; r += tile) {
    for (std::size_t c = 0; c <= r; c += tile) tiles.push_back({r, c, std::min(tile, n - r), std::min(tile, n - c)});
  }
  return tiles;
}

}  // namespace front_tiles

using front_tiles::Tile, front_tiles::tile, front_tiles::lower_tiles;

namespace {

constexpr std::size_t tiled_from = 768;  // rows of a front from which tiles pay

int factorize_front_in_tiles(std::size_t k, std::size_t m, double* panel, double* update) {
  const std::size_t ld = k + m;
  for (std::size_t c = 0; c < k; c += tile) {
    const std::size_t width = std::min(tile, k - c);
    double* corner = panel + c * ld + c;
    if (const int bad = dense::cholesky(width, corner, ld)) return static_cast<int>(c) + bad;
    const std::size_t below = ld - c - width;
    parallel_tasks((below + tile - 1) / tile, [&](std::size_t task, int) {
      const std::size_t row = task * tile;
      dense::solve_right_transposed(std::min(tile, below - row), width, corner, ld, corner + width + row, ld);
    });
    // The columns of the panel that are left.
    const double* left = corner + width;
    double* right = panel + (c + width) * ld + c + width;
    const std::size_t columns = k - c - width;
    std::vector<Tile> tiles;
    for (std::size_t q = 0; q < columns; q += tile) {
      for (std::size_t r = q; r < below; r += tile) {
        tiles.push_back({r, q, std::min(tile, below - r), std::min(tile, columns - q)});
      }
    }
    parallel_tasks(tiles.size(), [&](std::size_t task, int) {
      const auto& [row, column, rows, cols] = tiles[task];
      dense::subtract_product_transposed(rows, cols, width, left + row, ld, left + column, ld,
                                         right + column * ld + row, ld);
    });
  }
  subtract_in_tiles(m, k, {panel + k, ld}, {panel + k, ld}, {update, m});
  return 0;
}

}  // namespace

void subtract_in_tiles(std::size_t m, std::size_t k, Strided<const double> a, Strided<const double> b,
                       Strided<double> c) {
  const std::vector<Tile> tiles = lower_tiles(m);
  parallel_tasks(tiles.size(), [&](std::size_t task, int) {
    const auto& [row, column, rows, columns] = tiles[task];
    double* target = c.data + column * c.ld + row;
    if (row == column && a.data == b.data) {
      dense::subtract_square(rows, k, a.data + row, a.ld, target, c.ld);
    } else {
      dense::subtract_product_transposed(rows, columns, k, a.data + row, a.ld, b.data + column, b.ld, target, c.ld);
    }
  });
}

int factorize_front(std::size_t k, std::size_t m, double* panel, double* update) {
  const std::size_t ld = k + m;
  if (ld >= tiled_from) return factorize_front_in_tiles(k, m, panel, update);
  if (const int bad = dense::cholesky(k, panel, ld)) return bad;
  dense::solve_right_transposed(m, k, panel, ld, panel + k, ld);
  dense::subtract_square(m, k, panel + k, ld, update, m);
  return 0;
}

void add_matrix_columns(const SymbolicFactor& symbolic, const MatrixOnGraph& k, std::size_t t, double* panel,
                        std::size_t ld) {
  const auto b = static_cast<std::size_t>(symbolic.block);
  const auto& node = symbolic.tree.nodes[t];
  const auto& rows = symbolic.rows[t];
  const std::int32_t own = node.end - node.begin;
  for (std::int32_t p = node.begin; p < node.end; ++p) {
    const std::int32_t disc = symbolic.tree.order[p];
    double* column = panel + static_cast<std::size_t>(p - node.begin) * b * ld;
    const double* diagonal = k.matrix.diagonal_block(disc);
    double* at = column + static_cast<std::size_t>(p - node.begin) * b;
    for (std::size_t c = 0; c < b; ++c) {
      for (std::size_t r = c; r < b; ++r) at[c * ld + r] += diagonal[r * b + c];
    }
    for (const auto& edge : k.graph.of(disc)) {
      const std::int32_t q = symbolic.position[edge.other];
      if (q <= p) continue;
      const std::int32_t row =
          q < node.end ? q - node.begin
                       : own + static_cast<std::int32_t>(std::lower_bound(rows.begin(), rows.end(), q) - rows.begin());
      const double* block = k.matrix.coupling_block(edge.contact);
      const bool transposed = k.assembly.contacts[edge.contact].i == disc;  // wanted: K_qp
      at = column + static_cast<std::size_t>(row) * b;
      for (std::size_t c = 0; c < b; ++c) {
        for (std::size_t r = 0; r < b; ++r) {
          at[c * ld + r] += transposed ? block[c * b + r] : block[r * b + c];
        }
      }
    }
  }
}

void extend_add(const std::vector<RowRun>& runs, int block, const double* child, std::size_t child_size,
                const ParentFront& parent) {
  const auto b = static_cast<std::size_t>(block);
  const std::size_t own = parent.own * b;
  const std::size_t update_size = parent.ld - own;
  for (std::size_t first = 0; first < runs.size(); ++first) {
    const RowRun& columns = runs[first];
    for (std::size_t j = 0; j < columns.count * b; ++j) {
      const double* from = child + (columns.child * b + j) * child_size;
      const std::size_t column = columns.parent * b + j;
      // Rows count from the parent's first own unknown; the update matrix starts at row `own`.
      double* to =
          column < own ? parent.panel + column * parent.ld : parent.update + (column - own) * update_size - own;
      for (std::size_t k = first; k < runs.size(); ++k) {
        const std::size_t skip = k == first ? j : 0;
        const std::size_t count = runs[k].count * b - skip;
        const double* source = from + runs[k].child * b + skip;
        double* target = to + runs[k].parent * b + skip;
        for (std::size_t r = 0; r < count; ++r) target[r] += source[r];
      }
    }
  }
}

namespace {

constexpr std::size_t block_columns = 48;

/// A column of the front as the pivots so far have left it, rows `first` .. size.
struct FrontColumn {
  std::size_t index = 0;
  std::vector<double> values;  // by row; rows before `first` are not set
};

class Elimination {
 public:
  Elimination(IndefiniteFront& front, double u, double zero)
      : front_(front), u_(u), zero_(zero), n_(front.size), scaled_(block_columns * front.size + front.size) {
    one_.values.resize(n_);
    two_.values.resize(n_);
  }

  FrontPivots run() {
    std::size_t tried = 0;  // candidates refused since the last pivot
    while (done_ + tried < front_.candidates) {
      const std::size_t width = eliminate_next(done_ + tried);
      tried = width > 0 ? 0 : tried + 1;
      if (done_ - block_ >= block_columns - 1) finish_block();
    }
    finish_block();
    update_rest();
    pivots_.count = done_;
    return std::move(pivots_);
  }

 private:
  double& at(std::size_t row, std::size_t column) { return front_.values[column * n_ + row]; }
  /// L D of the pivots of this block.
  double& scaled(std::size_t row, std::size_t pivot) { return scaled_[(pivot - block_) * n_ + row]; }

  /// Column j of the Schur complement: what is stored, less the pivots of this block.
  void current_column(std::size_t j, FrontColumn& column) {
    column.index = j;
    auto& v = column.values;
    for (std::size_t r = done_; r < j; ++r) v[r] = at(j, r);
    for (std::size_t r = j; r < n_; ++r) v[r] = at(r, j);
    const std::size_t pivots = done_ - block_;
    if (pivots == 0) return;
    coefficients_.resize(pivots);
    for (std::size_t p = 0; p < pivots; ++p) coefficients_[p] = scaled(j, block_ + p);
    dense::subtract_product(n_ - done_, 1, pivots, &at(done_, block_), n_, coefficients_.data(), pivots, &v[done_], n_);
  }

  /// Largest entry outside the rows a and b, and the row of the largest among the candidates.
  std::pair<double, std::size_t> largest(const FrontColumn& column, std::size_t a, std::size_t b) const {
    double best = 0, best_candidate = -1;
    std::size_t row = n_;
    for (std::size_t r = done_; r < n_; ++r) {
      if (r == a || r == b) continue;
      const double value = std::abs(column.values[r]);
      best = std::max(best, value);
      if (r < front_.candidates && value > best_candidate) best_candidate = value, row = r;
    }
    return {best, row};
  }

  bool acceptable(const double& pivot, double column_maximum) const {
    return std::abs(pivot) > zero_ && std::abs(pivot) >= u_ * column_maximum;
  }

  /// Try candidate j as a pivot, alone or with a partner; returns how many were eliminated.
  std::size_t eliminate_next(std::size_t j) {
    current_column(j, one_);
    const auto [maximum, partner] = largest(one_, j, j);
    const double d = one_.values[j];
    if (acceptable(d, maximum)) return take_one(one_);
    if (partner == n_ || std::max(maximum, std::abs(d)) <= zero_) return 0;

    current_column(partner, two_);
    const double e = two_.values[partner], off = one_.values[partner];
    const double outside_one = largest(one_, j, partner).first, outside_two = largest(two_, j, partner).first;
    if (acceptable(e, std::max(outside_two, std::abs(off)))) return take_one(two_);
    const double determinant = d * e - off * off;
    const double scale = std::max({std::abs(d), std::abs(e), std::abs(off)});
    if (scale <= zero_ || std::abs(determinant) <= zero_ * scale) return 0;
    const double bound = std::abs(determinant) / u_;
    if (std::abs(e) * outside_one + std::abs(off) * outside_two > bound) return 0;
    if (std::abs(off) * outside_one + std::abs(d) * outside_two > bound) return 0;
    return take_two();
  }

  /// Exchange rows and columns a < b of what is not eliminated yet, and their rows in L.
  void exchange(std::size_t a, std::size_t b) {
    if (a == b) return;
    if (a > b) std::swap(a, b);
    std::swap(front_.ids[a], front_.ids[b]);
    for (std::size_t c = 0; c < done_; ++c) std::swap(at(a, c), at(b, c));
    for (std::size_t c = block_; c < done_; ++c) std::swap(scaled(a, c), scaled(b, c));
    for (std::size_t c = done_; c < a; ++c) std::swap(at(a, c), at(b, c));
    for (std::size_t r = a + 1; r < b; ++r) std::swap(at(r, a), at(b, r));
    for (std::size_t r = b + 1; r < n_; ++r) std::swap(at(r, a), at(r, b));
    std::swap(at(a, a), at(b, b));
    for (FrontColumn* column : {&one_, &two_}) {
      std::swap(column->values[a], column->values[b]);
      if (column->index == a || column->index == b) column->index = a + b - column->index;
    }
  }

  std::size_t take_one(const FrontColumn& column) {
    exchange(done_, column.index);
    const double d = column.values[done_];
    for (std::size_t r = done_ + 1; r < n_; ++r) {
      scaled(r, done_) = column.values[r];
      store(r, done_, column.values[r] / d);
    }
    at(done_, done_) = 1;
    pivots_.diagonal.push_back(d);
    pivots_.off_diagonal.push_back(0);
    ++done_;
    return 1;
  }

  std::size_t take_two() {
    exchange(done_, one_.index);
    exchange(done_ + 1, two_.index);
    const double d = one_.values[done_], off = one_.values[done_ + 1], e = two_.values[done_ + 1];
    const double determinant = d * e - off * off;
    for (std::size_t r = done_ + 2; r < n_; ++r) {
      const double v = one_.values[r], w = two_.values[r];
      scaled(r, done_) = v;
      scaled(r, done_ + 1) = w;
      store(r, done_, (e * v - off * w) / determinant);
      store(r, done_ + 1, (d * w - off * v) / determinant);
    }
    at(done_, done_) = at(done_ + 1, done_ + 1) = 1;
    at(done_ + 1, done_) = 0;
    pivots_.diagonal.insert(pivots_.diagonal.end(), {d, e});
    pivots_.off_diagonal.insert(pivots_.off_diagonal.end(), {off, 0});
    done_ += 2;
    return 2;
  }

  void store(std::size_t row, std::size_t column, const double& l) {
    at(row, column) = l;
    pivots_.growth = std::max(pivots_.growth, std::abs(l));
  }

  /// Bring the remaining candidate columns up to date with the pivots of this block.
  void finish_block() {
    const std::size_t pivots = done_ - block_;
    if (pivots > 0) {
      constexpr std::size_t strip = 64;
      const std::size_t left = front_.candidates - done_;
      parallel_tasks((left + strip - 1) / strip, [&](std::size_t task, int) {
        const std::size_t c = done_ + task * strip;
        dense::subtract_product_transposed(n_ - c, std::min(strip, front_.candidates - c), pivots, &at(c, block_), n_,
                                           &scaled(c, block_), n_, &at(c, c), n_);
      });
    }
    block_ = done_;
  }

  /// Rows that are no candidates are updated by all pivots at once.
  void update_rest() {
    const std::size_t c = front_.candidates, m = n_ - c;
    if (m == 0 || done_ == 0) return;
    std::vector<double> with_d(m * done_);
    for (std::size_t p = 0; p < done_; ++p) {
      const double off = pivots_.off_diagonal[p];
      const double before = p > 0 ? pivots_.off_diagonal[p - 1] : 0.0;
      for (std::size_t r = 0; r < m; ++r) {
        double value = pivots_.diagonal[p] * at(c + r, p);
        if (off != 0.0) value += off * at(c + r, p + 1);
        if (before != 0.0) value += before * at(c + r, p - 1);
        with_d[p * m + r] = value;
      }
    }
    subtract_in_tiles(m, done_, {&at(c, 0), n_}, {with_d.data(), m}, {&at(c, c), n_});
  }

  IndefiniteFront& front_;
  double u_, zero_;
  std::size_t n_;
  std::size_t done_ = 0;   // pivots so far
  std::size_t block_ = 0;  // first pivot of this block
  std::vector<double> scaled_, coefficients_;
  FrontColumn one_, two_;
  FrontPivots pivots_;
};

}  // namespace

FrontPivots factorize_indefinite(IndefiniteFront& front, double u, double zero) {
  return Elimination(front, u, zero).run();
}

}  // namespace equidem
