// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/linear/multifrontal/front.hpp"

#include <algorithm>

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

}  // namespace equidem
