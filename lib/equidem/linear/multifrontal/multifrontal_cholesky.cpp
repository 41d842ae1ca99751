// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/linear/multifrontal/multifrontal_cholesky.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <optional>
#include <type_traits>
#include <utility>
#include <vector>

#include "equidem/core/stopwatch.hpp"
#include "equidem/core/threads.hpp"
#include "equidem/linear/kernels/panel_solve.hpp"
#include "equidem/linear/large_buffer.hpp"
#include "equidem/linear/multifrontal/dense_kernels.hpp"
#include "equidem/linear/multifrontal/front.hpp"
#include "equidem/linear/multifrontal/tree_sweep.hpp"

namespace equidem {
namespace cholesky_factor {

/// The smallest pivot found, over the diagonal entry it started from.
struct PivotWatch {
  double smallest = std::numeric_limits<double>::infinity();
  std::optional<std::size_t> component{};

  void merge(const PivotWatch& other) {
    const bool less =
        other.smallest < smallest || (other.smallest == smallest && other.component && other.component < component);
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
    watch.merge({share, disc * b + p % b});
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

void CholeskyFactor::solve(std::span<double> x, int right_hand_sides) {
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

std::optional<std::vector<double>> CholeskyFactor::softest_motion() const {
  if (!report_.smallest_component) return {};
  const auto b = static_cast<std::size_t>(symbolic_->block);
  const std::size_t n = symbolic_->position.size() * b;
  LargeVector<double> y(n);
  std::fill(y.begin(), y.end(), 0.0);
  std::vector<double> x(n);
  const std::size_t component = *report_.smallest_component;
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

namespace {

/// A pivot below this is round-off of zero; the scaled entries are about 1.
constexpr double zero_pivot = 1e-12;

/// Index of each unknown in the front at hand; one per thread, never cleared: only ids of the front are read.
std::vector<std::int32_t>& index_of_unknown(std::size_t unknowns) {
  thread_local std::vector<std::int32_t> index;
  if (index.size() < unknowns) index.resize(unknowns);
  return index;
}

class LdltFactor final : public Factorization {
 public:
  LdltFactor(std::shared_ptr<const SymbolicFactor> symbolic, const MatrixOnGraph& k, const IndefiniteOptions& options);

  void solve(std::span<double> x, int right_hand_sides) override;
  [[nodiscard]] std::optional<std::vector<double>> softest_motion() const override {
    return softest_ ? std::optional(motion_of(*softest_)) : std::nullopt;
  }
  [[nodiscard]] std::vector<double> null_motion(std::int64_t k) const override { return motion_of(null_.at(k)); }
  [[nodiscard]] std::vector<std::size_t> null_components() const override;
  [[nodiscard]] const FactorReport& report() const override { return report_; }

 private:
  using Pivots = FrontPivots;
  using Front = IndefiniteFront;
  using Sweep = TreeSweep;
  using Children = std::vector<Sweep::Child>;

  /// The factor of a front: its pivots with their part of L, and the rows that they update.
  struct FrontFactor {
    Pivots pivots;
    /// Unknowns in the order of elimination: pivots first, then delayed ones, then later rows.
    std::vector<std::int64_t> ids;
    LargeVector<double> lower;  ///< ids.size() x pivots.count, column-major
    std::size_t delayed = 0;
  };

  [[nodiscard]] std::size_t unknowns() const { return symbolic_->position.size() * symbolic_->block; }
  [[nodiscard]] std::vector<double> motion_of(std::int64_t unknown) const;
  [[nodiscard]] std::size_t component_of(std::int64_t unknown) const;
  void choose_scales(const MatrixOnGraph& k);
  void factorize(const MatrixOnGraph& k);
  void factorize_front_of(std::size_t t, const MatrixOnGraph& k, const Children& children,
                          std::vector<LargeVector<double>>& updates);
  void scale_columns(Front& front, std::size_t own, std::size_t delayed) const;
  void scale(std::vector<double>& y) const;
  static void make_room(Front& front, std::size_t own, std::size_t delayed);
  void add_child(std::size_t child, const LargeVector<double>& update, const std::vector<std::int32_t>& index,
                 Front& front) const;
  void keep(const Front& front, FrontFactor& factor, LargeVector<double>& update);
  void write_report();
  void forward(std::vector<double>& y) const;
  static void divide_by_d(const FrontFactor& f, std::vector<double>& y);
  void backward(std::vector<double>& y) const;
  [[nodiscard]] double solve_work(std::size_t t) const;

  std::shared_ptr<const SymbolicFactor> symbolic_;
  IndefiniteOptions options_;
  std::vector<double> scale_;  // by row, in the order of elimination
  std::vector<FrontFactor> fronts_;
  std::optional<Sweep> solve_sweep_;  // once the pivots of the fronts are known
  BufferPool pool_;
  FactorReport report_;
  std::optional<std::int64_t> softest_;  // unknown of the smallest pivot
  std::vector<std::int64_t> null_;       // unknowns that nothing holds
};

LdltFactor::LdltFactor(std::shared_ptr<const SymbolicFactor> symbolic, const MatrixOnGraph& k,
                       const IndefiniteOptions& options)
    : symbolic_(std::move(symbolic)), options_(options), fronts_(symbolic_->fronts()) {
  const dense::OneThreadPerCall one_thread;
  choose_scales(k);
  factorize(k);
  solve_sweep_.emplace(*symbolic_, [&](std::size_t t) { return solve_work(t); });
  write_report();
}

void LdltFactor::solve(std::span<double> x, int right_hand_sides) {
  const dense::OneThreadPerCall one_thread;
  std::vector<double> y(unknowns());
  const std::size_t n = unknowns();
  for (int c = 0; c < right_hand_sides; ++c) {
    const std::span<double> column = x.subspan(c * n, n);
    permute_to_elimination(*symbolic_, column, y);
    scale(y);
    forward(y);
    backward(y);
    scale(y);
    permute_from_elimination(*symbolic_, y, column);
  }
}

std::vector<double> LdltFactor::motion_of(std::int64_t unknown) const {
  const dense::OneThreadPerCall one_thread;
  std::vector<double> y(unknowns(), 0.0), x(unknowns());
  y[unknown] = 1;
  backward(y);
  scale(y);
  permute_from_elimination(*symbolic_, y, x);
  return x;
}

std::size_t LdltFactor::component_of(std::int64_t unknown) const {
  const auto b = static_cast<std::size_t>(symbolic_->block), position = static_cast<std::size_t>(unknown);
  return static_cast<std::size_t>(symbolic_->tree.order[position / b]) * b + position % b;
}

std::vector<std::size_t> LdltFactor::null_components() const {
  std::vector<std::size_t> components;
  for (const std::int64_t unknown : null_) components.push_back(component_of(unknown));
  return components;
}

void LdltFactor::factorize(const MatrixOnGraph& k) {
  std::vector<LargeVector<double>> updates(fronts_.size());  // Schur complements that wait for their parents
  Progress progress("factorizing");
  double done = 0;
  const Sweep sweep(*symbolic_, [&](std::size_t t) { return symbolic_->front_operations(t) + 1000; });
  sweep.up([](std::size_t) { return std::size_t{0}; },
           [&](std::size_t t, double*, const Children& children) { factorize_front_of(t, k, children, updates); },
           [&](double work) { progress.update(done += work); });
  pool_.clear();
}

void LdltFactor::factorize_front_of(std::size_t t, const MatrixOnGraph& k, const Children& children,
                                    std::vector<LargeVector<double>>& updates) {
  const auto b = static_cast<std::int64_t>(symbolic_->block);
  const auto& node = symbolic_->tree.nodes[t];
  Front front;
  for (std::int64_t p = node.begin * b; p < node.end * b; ++p) front.ids.push_back(p);
  const std::size_t own = front.ids.size();
  for (const auto& child : children) {
    const FrontFactor& f = fronts_[child.node];
    const auto first = f.ids.begin() + static_cast<std::ptrdiff_t>(f.pivots.count);
    front.ids.insert(front.ids.end(), first, first + static_cast<std::ptrdiff_t>(f.delayed));
  }
  front.candidates = front.ids.size();
  for (const std::int32_t row : symbolic_->rows[t]) {
    for (std::int64_t r = 0; r < b; ++r) front.ids.push_back(row * b + r);
  }
  front.size = front.ids.size();
  const std::size_t n = front.size;
  LargeVector<double> values = pool_.take(n * n);
  front.values = values.data();
  std::fill(front.values, front.values + n * n, 0.0);

  // Columns of K count rows as if nothing had been delayed: the delayed ones are skipped over.
  add_matrix_columns(*symbolic_, k, t, front.values, n);
  scale_columns(front, own, front.candidates - own);
  make_room(front, own, front.candidates - own);
  auto& index = index_of_unknown(unknowns());
  for (std::size_t r = 0; r < n; ++r) index[front.ids[r]] = static_cast<std::int32_t>(r);
  for (const auto& child : children) {
    add_child(child.node, updates[child.node], index, front);
    pool_.give_back(std::move(updates[child.node]));
  }
  FrontFactor& factor = fronts_[t];
  factor.pivots = factorize_indefinite(front, options_.threshold, zero_pivot);
  factor.delayed = front.candidates - factor.pivots.count;
  keep(front, factor, updates[t]);
  pool_.give_back(std::move(values));
}

// Rows and columns are scaled to entries about 1, by powers of two, so that nothing is rounded: a pivot then
// counts as zero by its own stiffness, however much smaller than others that is.
void LdltFactor::choose_scales(const MatrixOnGraph& k) {
  const auto b = static_cast<std::size_t>(symbolic_->block);
  std::vector<double> largest(unknowns(), 0.0);
  const auto raise = [&](std::size_t disc, std::size_t r, const double& entry) {
    double& row = largest[symbolic_->position[disc] * b + r];
    row = std::max(row, std::abs(entry));
  };
  for (std::size_t d = 0; d < symbolic_->position.size(); ++d) {
    for (std::size_t e = 0; e < b * b; ++e) raise(d, e / b, k.matrix.diagonal_block(d)[e]);
  }
  for (std::size_t c = 0; c < k.assembly.contacts.size(); ++c) {
    for (std::size_t e = 0; e < b * b; ++e) {
      raise(k.assembly.contacts[c].i, e / b, k.matrix.coupling_block(c)[e]);
      raise(k.assembly.contacts[c].j, e % b, k.matrix.coupling_block(c)[e]);
    }
  }
  scale_.assign(unknowns(), 1.0);
  for (std::size_t p = 0; p < scale_.size(); ++p) {
    if (largest[p] > 0) scale_[p] = std::ldexp(1.0, -(std::ilogb(largest[p]) / 2));
  }
}

void LdltFactor::scale_columns(Front& front, std::size_t own, std::size_t delayed) const {
  for (std::size_t c = 0; c < own; ++c) {
    double* column = front.values + c * front.size;
    const double here = scale_[front.ids[c]];
    for (std::size_t r = 0; r < front.size - delayed; ++r) {
      column[r] *= here * scale_[front.ids[r < own ? r : r + delayed]];
    }
  }
}

void LdltFactor::scale(std::vector<double>& y) const {
  for (std::size_t p = 0; p < y.size(); ++p) y[p] *= scale_[p];
}

// Shifts the rows of later discs, assembled right behind the own ones, past `delayed` rows.
void LdltFactor::make_room(Front& front, std::size_t own, std::size_t delayed) {
  if (delayed == 0) return;
  const std::size_t n = front.size;
  for (std::size_t c = 0; c < own; ++c) {
    double* column = front.values + c * n;
    std::move_backward(column + own, column + n - delayed, column + n);
    std::fill(column + own, column + own + delayed, 0.0);
  }
}

void LdltFactor::add_child(std::size_t child, const LargeVector<double>& update, const std::vector<std::int32_t>& index,
                           Front& front) const {
  const FrontFactor& f = fronts_[child];
  const std::size_t m = f.ids.size() - f.pivots.count;
  const std::int64_t* ids = f.ids.data() + f.pivots.count;
  for (std::size_t c = 0; c < m; ++c) {
    const std::int32_t column = index[ids[c]];
    for (std::size_t r = c; r < m; ++r) {
      const std::int32_t row = index[ids[r]];
      front.values[std::min(row, column) * front.size + std::max(row, column)] += update.data()[c * m + r];
    }
  }
}

void LdltFactor::keep(const Front& front, FrontFactor& factor, LargeVector<double>& update) {
  const std::size_t n = front.size, k = factor.pivots.count, m = n - k;
  factor.ids = front.ids;
  factor.lower = LargeVector<double>(n * k);
  std::copy(front.values, front.values + n * k, factor.lower.data());
  update = pool_.take(m * m);
  for (std::size_t c = 0; c < m; ++c) {
    const double* from = front.values + (k + c) * n + k;
    std::copy(from + c, from + m, update.data() + c * m + c);
  }
}

void LdltFactor::write_report() {
  report_.name = "multifrontal L D L^T";
  std::int64_t negative = 0;
  report_.smallest_pivot = 1;
  double smallest = std::numeric_limits<double>::infinity();
  for (std::size_t t = 0; t < fronts_.size(); ++t) {
    const FrontFactor& f = fronts_[t];
    const double k = static_cast<double>(f.pivots.count), n = static_cast<double>(f.ids.size());
    report_.nonzeros += k * n - k * (k - 1) / 2;
    report_.bytes += sizeof(double) * k * n;
    report_.growth = std::max(report_.growth, f.pivots.growth);
    report_.delayed_pivots += static_cast<std::int64_t>(f.delayed);
    for (std::size_t p = 0; p < f.pivots.count; ++p) {
      const double d = f.pivots.diagonal[p], off = f.pivots.off_diagonal[p];
      const bool two = off != 0.0;
      const double e = two ? f.pivots.diagonal[p + 1] : 0.0, determinant = d * e - off * off;
      negative += two ? (determinant < 0 ? 1 : (d + e < 0 ? 2 : 0)) : (d < 0 ? 1 : 0);
      const double size =
          two ? std::abs(determinant) / std::max({std::abs(d), std::abs(e), std::abs(off)}) : std::abs(d);
      if (two) ++p;
      if (size < smallest) smallest = size, softest_ = f.ids[p];
    }
    if (symbolic_->tree.nodes[t].parent >= 0 || f.delayed == 0) continue;
    report_.zero_pivots += static_cast<std::int64_t>(f.delayed);
    for (std::size_t r = f.pivots.count; r < f.pivots.count + f.delayed; ++r) null_.push_back(f.ids[r]);
    smallest = 0;
    softest_ = f.ids[f.pivots.count];
  }
  report_.negative_pivots = negative;
  report_.smallest_pivot = smallest;
  if (softest_) report_.smallest_component = component_of(*softest_);
}

void LdltFactor::forward(std::vector<double>& y) const {
  std::vector<std::vector<double>> handed(fronts_.size());
  solve_sweep_->up([](std::size_t) { return std::size_t{0}; },
                   [&](std::size_t t, double*, const Children& children) {
                     const FrontFactor& f = fronts_[t];
                     const std::size_t n = f.ids.size(), k = f.pivots.count;
                     std::vector<double> x(n, 0.0);
                     auto& index = index_of_unknown(unknowns());
                     for (std::size_t r = 0; r < n; ++r) index[f.ids[r]] = static_cast<std::int32_t>(r);
                     // Right-hand sides enter where unknowns are own; what was delayed comes with the child that
                     // had it.
                     const auto b = static_cast<std::int64_t>(symbolic_->block);
                     const auto& node = symbolic_->tree.nodes[t];
                     for (std::int64_t p = node.begin * b; p < node.end * b; ++p) x[index[p]] = y[p];
                     for (const auto& child : children) {
                       const FrontFactor& g = fronts_[child.node];
                       const auto& values = handed[child.node];
                       for (std::size_t r = 0; r < values.size(); ++r) x[index[g.ids[g.pivots.count + r]]] += values[r];
                       handed[child.node] = {};
                     }
                     dense::solve_lower(k, 1, f.lower.data(), n, x.data(), n, true);
                     dense::subtract_product(n - k, 1, k, f.lower.data() + k, n, x.data(), n, x.data() + k, n);
                     for (std::size_t p = 0; p < k; ++p) y[f.ids[p]] = x[p];
                     if (symbolic_->tree.nodes[t].parent >= 0) {
                       handed[t].assign(x.begin() + static_cast<std::ptrdiff_t>(k), x.end());
                     } else {
                       for (std::size_t r = k; r < n; ++r) y[f.ids[r]] = 0;  // nothing holds these
                     }
                     divide_by_d(f, y);
                   },
                   [](double) {});
}

void LdltFactor::divide_by_d(const FrontFactor& f, std::vector<double>& y) {
  for (std::size_t p = 0; p < f.pivots.count; ++p) {
    const double d = f.pivots.diagonal[p], off = f.pivots.off_diagonal[p];
    if (off == 0.0) {
      y[f.ids[p]] /= d;
      continue;
    }
    const double e = f.pivots.diagonal[p + 1], determinant = d * e - off * off;
    double& v = y[f.ids[p]];
    double& w = y[f.ids[p + 1]];
    const double new_v = (e * v - off * w) / determinant;
    w = (d * w - off * v) / determinant;
    v = new_v;
    ++p;
  }
}

void LdltFactor::backward(std::vector<double>& y) const {
  solve_sweep_->down([&](std::size_t t) {
    const FrontFactor& f = fronts_[t];
    const std::size_t n = f.ids.size(), k = f.pivots.count;
    std::vector<double> x(n);
    for (std::size_t r = 0; r < n; ++r) x[r] = y[f.ids[r]];
    dense::subtract_transposed_product(k, 1, n - k, f.lower.data() + k, n, x.data() + k, n, x.data(), n);
    dense::solve_lower_transposed(k, 1, f.lower.data(), n, x.data(), n, true);
    for (std::size_t p = 0; p < k; ++p) y[f.ids[p]] = x[p];
  });
}

double LdltFactor::solve_work(std::size_t t) const {
  return static_cast<double>(fronts_[t].pivots.count * fronts_[t].ids.size() + 100);
}

}  // namespace

std::unique_ptr<Factorization> multifrontal_ldlt(std::shared_ptr<const SymbolicFactor> symbolic,
                                                 const MatrixOnGraph& matrix, const IndefiniteOptions& options) {
  return std::make_unique<LdltFactor>(std::move(symbolic), matrix, options);
}

}  // namespace equidem
