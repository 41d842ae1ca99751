// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/linear/multifrontal/updated_cholesky.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace equidem {

UpdatedCholesky::UpdatedCholesky(std::shared_ptr<const SymbolicFactor> symbolic)
    : factor_(std::move(symbolic)), front_of_(this->symbolic().position.size()) {
  const auto& nodes = this->symbolic().tree.nodes;
  for (std::size_t t = 0; t < nodes.size(); ++t) {
    std::fill(front_of_.begin() + nodes[t].begin, front_of_.begin() + nodes[t].end, static_cast<std::int32_t>(t));
  }
}

bool UpdatedCholesky::factorize(const MatrixOnGraph& k) {
  if (stiffness_.empty()) {
    const auto b = static_cast<std::size_t>(symbolic().block);
    for (const std::int32_t disc : symbolic().tree.order) {
      for (std::size_t r = 0; r < b; ++r) stiffness_.push_back(k.matrix.diagonal_block(disc)[r * (b + 1)]);
    }
  }
  return factor_.factorize(k) && report().smallest_pivot > least_pivot;
}

double UpdatedCholesky::stiffness_of(std::int64_t component) const {
  const std::int64_t b = symbolic().block;
  return stiffness_[symbolic().position[component / b] * b + component % b];
}

std::vector<std::int32_t> UpdatedCholesky::path_of(std::int32_t i, std::int32_t j) const {
  std::vector<std::int32_t> path;
  const auto& position = symbolic().position;
  for (std::int32_t t = front_of_[std::min(position[i], position[j])]; t >= 0; t = symbolic().tree.nodes[t].parent) {
    path.push_back(t);
  }
  return path;
}

FactorPath UpdatedCholesky::change(std::span<const RankOneChange> changes, std::span<const Load> loads) {
  const SymbolicFactor& tree = symbolic();
  const auto b = static_cast<std::size_t>(tree.block);
  const std::int32_t i = changes.front().i, j = changes.front().j;
  FactorPath path;
  path.fronts = path_of(i, j);

  // Columns: vectors of the changes, then loads. A negative change comes last: it takes from what the others add.
  std::vector<std::size_t> ordered(changes.size());
  std::iota(ordered.begin(), ordered.end(), std::size_t{0});
  std::stable_sort(ordered.begin(), ordered.end(),
                   [&](std::size_t p, std::size_t q) { return changes[p].stiffness > 0 && changes[q].stiffness < 0; });
  const std::size_t columns = ordered.size() + loads.size();
  std::vector<double> signs;
  std::vector<double> work, next;
  const auto rows_of = [&](std::size_t t) { return tree.pivots(t) + tree.updates(t); };
  {
    const auto t = static_cast<std::size_t>(path.fronts.front());
    const auto& node = tree.tree.nodes[t];
    const auto row_of = [&](std::int32_t disc) {
      const std::int32_t p = tree.position[disc];
      if (p < node.end) return (p - node.begin) * b;
      const auto& rows = tree.rows[t];
      return tree.pivots(t) + (std::lower_bound(rows.begin(), rows.end(), p) - rows.begin()) * b;
    };
    const std::size_t ld = rows_of(t), at_i = row_of(i), at_j = row_of(j);
    work.assign(ld * columns, 0.0);
    const auto scatter = [&](std::size_t column, double factor, const auto& from) {
      for (std::size_t r = 0; r < b; ++r) {
        work[column * ld + at_i + r] += factor * from.at_i[r];
        work[column * ld + at_j + r] += factor * from.at_j[r];
      }
    };
    for (std::size_t k = 0; k < ordered.size(); ++k) {
      const RankOneChange& change = changes[ordered[k]];
      signs.push_back(change.stiffness < 0 ? -1 : 1);
      scatter(k, std::sqrt(std::abs(change.stiffness)), change);
    }
    for (std::size_t c = 0; c < loads.size(); ++c) scatter(ordered.size() + c, 1, loads[c]);
  }

  PanelChangeResult result;
  std::vector<RowRun> runs;
  for (const std::int32_t t : path.fronts) {
    const std::size_t pivots = tree.pivots(t), ld = rows_of(t);
    const auto& node = tree.tree.nodes[t];
    double* const right = work.data() + ordered.size() * ld;
    result.vanished.clear();
    change_panel({.values = factor_.panel(t),
                  .pivots = pivots,
                  .rows = ld,
                  .vectors = work.data(),
                  .signs = signs.data(),
                  .changes = ordered.size(),
                  .right = right,
                  .right_sides = loads.size(),
                  .stiffness = stiffness_.data() + node.begin * b,
                  .least = least_pivot},
                 result);
    for (const std::size_t p : result.vanished) {
      path.held.push_back(static_cast<std::int64_t>(tree.tree.order[node.begin + p / b] * b + p % b));
    }
    for (std::size_t c = 0; c < loads.size(); ++c) {
      path.values.insert(path.values.end(), right + c * ld, right + c * ld + pivots);
    }
    if (node.parent < 0) break;
    match_rows(tree, t, runs);
    const std::size_t ld_next = rows_of(node.parent);
    next.assign(ld_next * columns, 0.0);
    for (std::size_t c = 0; c < columns; ++c) {
      for (const RowRun& run : runs) {
        std::copy_n(work.data() + c * ld + pivots + run.child * b, run.count * b,
                    next.data() + c * ld_next + run.parent * b);
      }
    }
    std::swap(work, next);
  }
  path.share = result.share;
  return path;
}

}  // namespace equidem
