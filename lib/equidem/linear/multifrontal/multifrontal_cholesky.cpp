// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/linear/multifrontal/multifrontal_cholesky.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <type_traits>
#include <utility>
#include <vector>

#include "equidem/core/progress.hpp"
#include "equidem/core/threads.hpp"
#include "equidem/linear/kernels/panel_solve.hpp"
#include "equidem/linear/large_buffer.hpp"
#include "equidem/linear/multifrontal/dense_kernels.hpp"
#include "equidem/linear/multifrontal/tree_sweep.hpp"

namespace equidem {
namespace cholesky_factor {

/// The smallest pivot found, over the diagonal entry it started from.
struct PivotWatch {
  double smallest = std::numeric_limits<double>::infinity();
  std::int64_t component = -1;

  void merge(const PivotWatch& other) {
    const bool less = other.smallest < smallest ||
                      (other.smallest == smallest && other.component >= 0 && other.component < component);
    if (less) *this = other;
  }
};

}  // namespace cholesky_factor

using cholesky_factor::PivotWatch;

namespace {

/// Zeros on and below the diagonal of the first columns of a matrix; nothing reads the others.
void clear_lower(std::size_t columns, std::size_t rows, double* values) {
  for (std::size_t c = 0; c < columns; ++c) std::fill_n(values + c * rows + c, rows - c, 0.0);
}

/// The smallest pivot of front t. \param bad 1-based index of the first that is not positive, or 0
PivotWatch watch_front(const CholeskyFactor& factor, const MatrixOnGraph& k, std::size_t t, int bad) {
  const SymbolicFactor& symbolic = factor.symbolic();
  const auto b = static_cast<std::size_t>(symbolic.block);
  const Panel panel = factor.panel(t);
  PivotWatch watch;
  for (std::size_t p = 0; p < (bad != 0 ? static_cast<std::size_t>(bad) : panel.pivots); ++p) {
    const std::int32_t disc = symbolic.tree.order[symbolic.tree.nodes[t].begin + p / b];
    const double entry = k.matrix.diagonal_block(disc)[(p % b) * (b + 1)];
    const double l = panel.values[p * (panel.rows + 1)];
    const double share = bad != 0 && p + 1 == static_cast<std::size_t>(bad) ? std::min(0.0, l / entry) : l * l / entry;
    watch.merge({share, static_cast<std::int64_t>(disc * b + p % b)});
  }
  return watch;
}

/// Columns of a front: own unknowns, then those that it updates.
std::vector<double>& work(std::size_t numbers) {
  thread_local std::vector<double> values;
  if (values.size() < numbers) values.resize(numbers);
  return values;
}

}  // namespace

CholeskyFactor::CholeskyFactor(std::shared_ptr<const SymbolicFactor> symbolic)
    : symbolic_(std::move(symbolic)),
      solve_sweep_(
          *symbolic_,
          [this](std::size_t t) {
            return static_cast<double>(symbolic_->pivots(t) * (symbolic_->pivots(t) + symbolic_->updates(t)) + 100);
          }),
      forward_sweep_(*symbolic_) {
  offset_.resize(symbolic_->fronts());
  std::size_t size = 0;
  for (std::size_t t = 0; t < offset_.size(); ++t) {
    offset_[t] = size;
    size += symbolic_->pivots(t) * (symbolic_->pivots(t) + symbolic_->updates(t));
  }
  panels_ = LargeVector<double>(size);
  report_.name = "multifrontal Cholesky";
  report_.nonzeros = symbolic_->nonzeros;
  report_.bytes = static_cast<double>(size) * sizeof(double);
  report_.negative_pivots = 0;
}

bool CholeskyFactor::factorize(const MatrixOnGraph& k) {
  const dense::OneThreadPerCall one_thread;
  bool positive = true;
  std::vector<std::uint8_t> failed(symbolic_->fronts(), 0);  // here or below: what stands above is not tried
  std::mutex watch_mutex;
  PivotWatch watch;
  Sweep sweep(*symbolic_, [&](std::size_t t) { return symbolic_->front_operations(t) + 1000; });
  Progress progress("factorizing");
  double done = 0;
  sweep.up([&](std::size_t t) { return symbolic_->updates(t) * symbolic_->updates(t); },
           [&](std::size_t t, double* update, const std::vector<Sweep::Child>& children) {
             const std::size_t pivots = symbolic_->pivots(t), updates = symbolic_->updates(t), ld = pivots + updates;
             double* const panel = this->panel(t);
             clear_lower(pivots, ld, panel);
             clear_lower(updates, updates, update);
             add_matrix_columns(*symbolic_, k, t, panel, ld);
             thread_local std::vector<RowRun> runs;
             for (const auto& child : children) {
               match_rows(*symbolic_, child.node, runs);
               extend_add(runs, symbolic_->block, child.values, symbolic_->updates(child.node),
                          {panel, ld, update, pivots / symbolic_->block});
             }
             if (std::any_of(children.begin(), children.end(), [&](const auto& c) { return failed[c.node] != 0; })) {
               failed[t] = 1;
               return;
             }
             const int bad = factorize_front(pivots, updates, panel, update);
             const PivotWatch found = watch_front(*this, k, t, bad);
             const std::lock_guard lock(watch_mutex);
             failed[t] = bad != 0 ? 1 : 0;
             if (bad != 0) positive = false;
             watch.merge(found);
           },
           [&](double work) {
             done += work;
             progress.update(done);
           });
  report_.smallest_pivot = watch.smallest;
  report_.smallest_component = watch.component;
  return positive;
}

void CholeskyFactor::solve(std::span<double> x, int right_hand_sides) const {
  const auto b = static_cast<std::size_t>(symbolic_->block);
  const auto columns = static_cast<std::size_t>(right_hand_sides);
  const std::size_t n = symbolic_->position.size() * b;
  LargeVector<double> y(n * columns);
  for (std::size_t c = 0; c < columns; ++c) {
    const std::span<double> column = x.subspan(c * n, n);
    permute_to_elimination(*symbolic_, column, std::span(y).subspan(c * n, n));
  }
  for (std::size_t c = 0; c < columns; c += most_columns) {
    const Columns some{y.data() + c * n, n, std::min(most_columns, columns - c)};
    forward(some);
    backward(some);
  }
  for (std::size_t c = 0; c < columns; ++c) {
    const std::span<double> column = x.subspan(c * n, n);
    permute_from_elimination(*symbolic_, std::span(y).subspan(c * n, n), column);
  }
}

void CholeskyFactor::forward(const Columns& y) const {
  forward_sweep_.run([this](std::size_t t) { return panel(t); }, y.data, y.size, y.count);
}

void CholeskyFactor::backward(const Columns& y) const {
  solve_sweep_.down([&](std::size_t t) { backward(t, y); });
}

std::vector<double> CholeskyFactor::softest_motion() const {
  const auto b = static_cast<std::size_t>(symbolic_->block);
  const std::size_t n = symbolic_->position.size() * b;
  LargeVector<double> y(n);
  std::fill(y.begin(), y.end(), 0.0);
  std::vector<double> x(n);
  const auto component = static_cast<std::size_t>(report_.smallest_component);
  y[symbolic_->position[component / b] * b + component % b] = 1;
  for (std::size_t t = symbolic_->fronts(); t-- > 0;) backward(t, {y.data(), n, 1});
  permute_from_elimination(*symbolic_, y, x);
  return x;
}

void CholeskyFactor::backward(std::size_t t, const Columns& y) const {
  const auto b = static_cast<std::size_t>(symbolic_->block);
  const Panel panel = this->panel(t);
  double* own = y.data + symbolic_->tree.nodes[t].begin * b;
  double* w = work(panel.rows * y.count).data();
  for (std::size_t c = 0; c < y.count; ++c) {
    double* to = std::copy_n(own + c * y.size, panel.pivots, w + c * panel.rows);
    for (const std::int32_t row : symbolic_->rows[t]) {
      for (std::size_t r = 0; r < b; ++r) *to++ = y.data[c * y.size + row * b + r];
    }
  }
  solve_backward(panel, w, y.count);
  for (std::size_t c = 0; c < y.count; ++c) std::copy_n(w + c * panel.rows, panel.pivots, own + c * y.size);
}

std::unique_ptr<Factorization> multifrontal_cholesky(std::shared_ptr<const SymbolicFactor> symbolic,
                                                     const MatrixOnGraph& matrix) {
  auto factor = std::make_unique<CholeskyFactor>(std::move(symbolic));
  if (!factor->factorize(matrix)) return nullptr;
  return factor;
}

}  // namespace equidem
