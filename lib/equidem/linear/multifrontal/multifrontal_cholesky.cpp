// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/linear/multifrontal/multifrontal_cholesky.hpp"

#include <algorithm>
#include <limits>
#include <mutex>
#include <utility>
#include <vector>

#include "equidem/core/progress.hpp"
#include "equidem/core/threads.hpp"
#include "equidem/linear/large_buffer.hpp"
#include "equidem/linear/multifrontal/dense_kernels.hpp"
#include "equidem/linear/multifrontal/tree_sweep.hpp"

namespace equidem {
namespace {

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

class Cholesky final : public Factorization {
 public:
  explicit Cholesky(std::shared_ptr<const SymbolicFactor> symbolic) : symbolic_(std::move(symbolic)) {
    dense::use_one_thread_per_call();
    offset_.resize(symbolic_->fronts());
    std::size_t size = 0;
    for (std::size_t t = 0; t < offset_.size(); ++t) {
      offset_[t] = size;
      size += symbolic_->pivots(t) * (symbolic_->pivots(t) + symbolic_->updates(t));
    }
    panels_ = LargeBuffer(size);
    report_.name = "multifrontal Cholesky";
    report_.nonzeros = symbolic_->nonzeros;
    report_.bytes = static_cast<double>(size) * sizeof(double);
    report_.negative_pivots = 0;
  }

  /// Whether all pivots are positive.
  bool factorize(const MatrixOnGraph& k) {
    bool positive = true;
    std::vector<std::uint8_t> failed(symbolic_->fronts(), 0);  // here or below: what stands above is not tried
    std::mutex watch_mutex;
    PivotWatch watch;
    TreeSweep sweep(*symbolic_, [&](std::size_t t) { return symbolic_->front_operations(t) + 1000; });
    Progress progress("factorizing");
    double done = 0;
    sweep.up([&](std::size_t t) { return symbolic_->updates(t) * symbolic_->updates(t); },
             [&](std::size_t t, double* update, const std::vector<TreeSweep::Child>& children) {
               const std::size_t pivots = symbolic_->pivots(t), updates = symbolic_->updates(t), ld = pivots + updates;
               double* panel = panels_.data() + offset_[t];
               std::fill_n(panel, pivots * ld, 0.0);
               std::fill_n(update, updates * updates, 0.0);
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
               const PivotWatch found = watch_front(k, t, bad);
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

  void solve(std::span<double> x, int right_hand_sides) const override {
    const auto b = static_cast<std::size_t>(symbolic_->block);
    const auto columns = static_cast<std::size_t>(right_hand_sides);
    const std::size_t n = symbolic_->position.size() * b;
    std::vector<double> y(n * columns);
    for (std::size_t c = 0; c < columns; ++c) {
      permute_to_elimination(*symbolic_, x.subspan(c * n, n), std::span(y).subspan(c * n, n));
    }
    TreeSweep sweep(*symbolic_, [&](std::size_t t) {
      return static_cast<double>(symbolic_->pivots(t) * (symbolic_->pivots(t) + symbolic_->updates(t)) + 100);
    });
    sweep.up([&](std::size_t t) { return symbolic_->updates(t) * columns; },
             [&](std::size_t t, double* update, const std::vector<TreeSweep::Child>& children) {
               forward(t, &y[symbolic_->tree.nodes[t].begin * b], n, update, children, columns);
             },
             [](double) {});
    sweep.down([&](std::size_t t) { backward(t, y, n, columns); });
    for (std::size_t c = 0; c < columns; ++c) {
      permute_from_elimination(*symbolic_, std::span(y).subspan(c * n, n), x.subspan(c * n, n));
    }
  }

  [[nodiscard]] std::vector<double> softest_motion() const override {
    const auto b = static_cast<std::size_t>(symbolic_->block);
    const std::size_t n = symbolic_->position.size() * b;
    std::vector<double> y(n, 0.0), x(n);
    const auto component = static_cast<std::size_t>(report_.smallest_component);
    y[symbolic_->position[component / b] * b + component % b] = 1;
    for (std::size_t t = symbolic_->fronts(); t-- > 0;) backward(t, y, n, 1);
    permute_from_elimination(*symbolic_, y, x);
    return x;
  }

  [[nodiscard]] const FactorReport& report() const override { return report_; }

 private:
  PivotWatch watch_front(const MatrixOnGraph& k, std::size_t t, int bad) const {
    const auto b = static_cast<std::size_t>(symbolic_->block);
    const std::size_t pivots = symbolic_->pivots(t), ld = pivots + symbolic_->updates(t);
    const double* panel = panels_.data() + offset_[t];
    PivotWatch watch;
    for (std::size_t p = 0; p < (bad != 0 ? static_cast<std::size_t>(bad) : pivots); ++p) {
      const std::int32_t disc = symbolic_->tree.order[symbolic_->tree.nodes[t].begin + p / b];
      const double entry = k.matrix.diagonal_block(disc)[(p % b) * (b + 1)];
      const double l = panel[p * (ld + 1)];
      const double share =
          bad != 0 && p + 1 == static_cast<std::size_t>(bad) ? std::min(0.0, l / entry) : l * l / entry;
      watch.merge({share, static_cast<std::int64_t>(disc * b + p % b)});
    }
    return watch;
  }

  // L y = b on the front: y_own := L_11^-1 (b_own + children), update := children - L_21 y_own.
  void forward(std::size_t t, double* own, std::size_t n, double* update, const std::vector<TreeSweep::Child>& children,
               std::size_t columns) const {
    const auto b = static_cast<std::size_t>(symbolic_->block);
    const std::size_t pivots = symbolic_->pivots(t), updates = symbolic_->updates(t), ld = pivots + updates;
    std::fill(update, update + updates * columns, 0.0);
    thread_local std::vector<RowRun> runs;
    for (const auto& child : children) {
      match_rows(*symbolic_, child.node, runs);
      const std::size_t rows = symbolic_->updates(child.node);
      for (std::size_t c = 0; c < columns; ++c) {
        for (const RowRun& run : runs) {
          const double* from = child.values + c * rows + run.child * b;
          const std::size_t at = run.parent * b;
          double* to = at < pivots ? own + c * n + at : update + c * updates + at - pivots;
          for (std::size_t r = 0; r < run.count * b; ++r) to[r] += from[r];
        }
      }
    }
    const double* panel = panels_.data() + offset_[t];
    dense::solve_lower(pivots, columns, panel, ld, own, n);
    dense::subtract_product(updates, columns, pivots, panel + pivots, ld, own, n, update, updates);
  }

  // L^T x = y on the front: x_own := L_11^-T (y_own - L_21^T x_rows).
  void backward(std::size_t t, std::vector<double>& y, std::size_t n, std::size_t columns) const {
    const auto b = static_cast<std::size_t>(symbolic_->block);
    const std::size_t pivots = symbolic_->pivots(t), updates = symbolic_->updates(t), ld = pivots + updates;
    thread_local std::vector<double> gathered;
    gathered.resize(updates * columns);
    for (std::size_t c = 0; c < columns; ++c) {
      double* to = gathered.data() + c * updates;
      for (const std::int32_t row : symbolic_->rows[t]) {
        for (std::size_t r = 0; r < b; ++r) *to++ = y[c * n + row * b + r];
      }
    }
    double* own = &y[symbolic_->tree.nodes[t].begin * b];
    const double* panel = panels_.data() + offset_[t];
    dense::subtract_transposed_product(pivots, columns, updates, panel + pivots, ld, gathered.data(), updates, own, n);
    dense::solve_lower_transposed(pivots, columns, panel, ld, own, n);
  }

  std::shared_ptr<const SymbolicFactor> symbolic_;
  std::vector<std::size_t> offset_;  // of the panel of each front
  LargeBuffer panels_;
  FactorReport report_;
};

}  // namespace

std::unique_ptr<Factorization> multifrontal_cholesky(std::shared_ptr<const SymbolicFactor> symbolic,
                                                     const MatrixOnGraph& matrix, FactorReport* report) {
  auto factor = std::make_unique<Cholesky>(std::move(symbolic));
  const bool positive = factor->factorize(matrix);
  if (report != nullptr) *report = factor->report();
  if (!positive) return nullptr;
  return factor;
}

}  // namespace equidem
