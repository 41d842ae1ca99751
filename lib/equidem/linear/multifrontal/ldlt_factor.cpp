// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/linear/multifrontal/ldlt_factor.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>
#include <utility>

#include "equidem/core/progress.hpp"
#include "equidem/core/threads.hpp"
#include "equidem/linear/multifrontal/dense_kernels.hpp"
#include "equidem/linear/multifrontal/front.hpp"

namespace equidem {
namespace {

/// A pivot below this is round-off of zero; the scaled entries are about 1.
constexpr double zero_pivot = 1e-12;

/// Index of each unknown in the front at hand; one per thread, never cleared: only ids of the front are read.
std::vector<std::int32_t>& index_of_unknown(std::size_t unknowns) {
  thread_local std::vector<std::int32_t> index;
  if (index.size() < unknowns) index.resize(unknowns);
  return index;
}

}  // namespace

template <typename Number>
LdltFactor<Number>::LdltFactor(std::shared_ptr<const SymbolicFactor> symbolic, const MatrixOnGraphOf<Number>& k,
                               const IndefiniteOptions& options)
    : symbolic_(std::move(symbolic)), options_(options), fronts_(symbolic_->fronts()) {
  dense::use_one_thread_per_call();
  choose_scales(k);
  factorize(k);
  write_report();
}

template <typename Number>
void LdltFactor<Number>::solve(std::span<Number> x, int right_hand_sides) const {
  std::vector<Number> y(unknowns());
  const std::size_t n = unknowns();
  for (int c = 0; c < right_hand_sides; ++c) {
    const std::span<Number> column = x.subspan(c * n, n);
    permute_to_elimination<Number, Number>(*symbolic_, column, y);
    scale(y);
    forward(y);
    backward(y);
    scale(y);
    permute_from_elimination<Number, Number>(*symbolic_, y, column);
  }
}

template <typename Number>
std::vector<Number> LdltFactor<Number>::motion_of(std::int64_t unknown) const {
  std::vector<Number> y(unknowns(), 0.0), x(unknowns());
  if (unknown >= 0) y[unknown] = 1;
  backward(y);
  scale(y);
  permute_from_elimination<Number, Number>(*symbolic_, y, x);
  return x;
}

template <typename Number>
std::vector<std::size_t> LdltFactor<Number>::null_components() const {
  const auto b = static_cast<std::size_t>(symbolic_->block);
  std::vector<std::size_t> components;
  for (const std::int64_t unknown : null_) {
    const auto position = static_cast<std::size_t>(unknown);
    components.push_back(static_cast<std::size_t>(symbolic_->tree.order[position / b]) * b + position % b);
  }
  return components;
}

template <typename Number>
void LdltFactor<Number>::factorize(const MatrixOnGraphOf<Number>& k) {
  std::vector<LargeVector<Number>> updates(fronts_.size());  // Schur complements that wait for their parents
  Progress progress("factorizing");
  double done = 0;
  const Sweep sweep(*symbolic_, [&](std::size_t t) { return symbolic_->front_operations(t) + 1000; });
  sweep.up([](std::size_t) { return std::size_t{0}; },
           [&](std::size_t t, Number*, const Children& children) { factorize_front_of(t, k, children, updates); },
           [&](double work) { progress.update(done += work); });
  pool_.clear();
}

template <typename Number>
void LdltFactor<Number>::factorize_front_of(std::size_t t, const MatrixOnGraphOf<Number>& k, const Children& children,
                                            std::vector<LargeVector<Number>>& updates) {
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
  LargeVector<Number> values = pool_.take(n * n);
  front.values = values.data();
  std::fill(front.values, front.values + n * n, Number(0));

  // Columns of K count rows as if nothing had been delayed: the delayed ones are skipped over.
  add_matrix_columns(*symbolic_, k, t, {}, front.values, n);
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
template <typename Number>
void LdltFactor<Number>::choose_scales(const MatrixOnGraphOf<Number>& k) {
  const auto b = static_cast<std::size_t>(symbolic_->block);
  std::vector<double> largest(unknowns(), 0.0);
  const auto raise = [&](std::size_t disc, std::size_t r, const Number& entry) {
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

template <typename Number>
void LdltFactor<Number>::scale_columns(Front& front, std::size_t own, std::size_t delayed) const {
  for (std::size_t c = 0; c < own; ++c) {
    Number* column = front.values + c * front.size;
    const double here = scale_[front.ids[c]];
    for (std::size_t r = 0; r < front.size - delayed; ++r) {
      column[r] *= here * scale_[front.ids[r < own ? r : r + delayed]];
    }
  }
}

template <typename Number>
void LdltFactor<Number>::scale(std::vector<Number>& y) const {
  for (std::size_t p = 0; p < y.size(); ++p) y[p] *= scale_[p];
}

// Shifts the rows of later discs, assembled right behind the own ones, past `delayed` rows.
template <typename Number>
void LdltFactor<Number>::make_room(Front& front, std::size_t own, std::size_t delayed) {
  if (delayed == 0) return;
  const std::size_t n = front.size;
  for (std::size_t c = 0; c < own; ++c) {
    Number* column = front.values + c * n;
    std::move_backward(column + own, column + n - delayed, column + n);
    std::fill(column + own, column + own + delayed, Number(0));
  }
}

template <typename Number>
void LdltFactor<Number>::add_child(std::size_t child, const LargeVector<Number>& update,
                                   const std::vector<std::int32_t>& index, Front& front) const {
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

template <typename Number>
void LdltFactor<Number>::keep(const Front& front, FrontFactor& factor, LargeVector<Number>& update) {
  const std::size_t n = front.size, k = factor.pivots.count, m = n - k;
  factor.ids = front.ids;
  factor.lower = LargeVector<Number>(n * k);
  std::copy(front.values, front.values + n * k, factor.lower.data());
  update = pool_.take(m * m);
  for (std::size_t c = 0; c < m; ++c) {
    const Number* from = front.values + (k + c) * n + k;
    std::copy(from + c, from + m, update.data() + c * m + c);
  }
}

template <typename Number>
void LdltFactor<Number>::write_report() {
  constexpr bool signed_pivots = std::is_same_v<Number, double>;
  report_.name = std::is_same_v<Number, double> ? "multifrontal L D L^T" : "multifrontal L D L^T of complex numbers";
  report_.negative_pivots = signed_pivots ? 0 : -1;
  report_.smallest_pivot = 1;
  double smallest = std::numeric_limits<double>::infinity();
  for (std::size_t t = 0; t < fronts_.size(); ++t) {
    const FrontFactor& f = fronts_[t];
    const double k = static_cast<double>(f.pivots.count), n = static_cast<double>(f.ids.size());
    report_.nonzeros += k * n - k * (k - 1) / 2;
    report_.bytes += sizeof(Number) * k * n;
    report_.growth = std::max(report_.growth, f.pivots.growth);
    report_.delayed_pivots += static_cast<std::int64_t>(f.delayed);
    for (std::size_t p = 0; p < f.pivots.count; ++p) {
      const Number d = f.pivots.diagonal[p], off = f.pivots.off_diagonal[p];
      const bool two = off != Number(0);
      const Number e = two ? f.pivots.diagonal[p + 1] : Number(0), determinant = d * e - off * off;
      if constexpr (signed_pivots) {
        report_.negative_pivots += two ? (determinant < 0 ? 1 : (d + e < 0 ? 2 : 0)) : (d < 0 ? 1 : 0);
      }
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
  report_.smallest_pivot = smallest;
  const auto b = static_cast<std::int64_t>(symbolic_->block);
  if (softest_ >= 0) report_.smallest_component = symbolic_->tree.order[softest_ / b] * b + softest_ % b;
}

template <typename Number>
void LdltFactor<Number>::forward(std::vector<Number>& y) const {
  std::vector<std::vector<Number>> handed(fronts_.size());
  const Sweep sweep(*symbolic_, [&](std::size_t t) { return solve_work(t); });
  sweep.up([](std::size_t) { return std::size_t{0}; },
           [&](std::size_t t, Number*, const Children& children) {
             const FrontFactor& f = fronts_[t];
             const std::size_t n = f.ids.size(), k = f.pivots.count;
             std::vector<Number> x(n, 0.0);
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

template <typename Number>
void LdltFactor<Number>::divide_by_d(const FrontFactor& f, std::vector<Number>& y) {
  for (std::size_t p = 0; p < f.pivots.count; ++p) {
    const Number d = f.pivots.diagonal[p], off = f.pivots.off_diagonal[p];
    if (off == Number(0)) {
      y[f.ids[p]] /= d;
      continue;
    }
    const Number e = f.pivots.diagonal[p + 1], determinant = d * e - off * off;
    Number& v = y[f.ids[p]];
    Number& w = y[f.ids[p + 1]];
    const Number new_v = (e * v - off * w) / determinant;
    w = (d * w - off * v) / determinant;
    v = new_v;
    ++p;
  }
}

template <typename Number>
void LdltFactor<Number>::backward(std::vector<Number>& y) const {
  const Sweep sweep(*symbolic_, [&](std::size_t t) { return solve_work(t); });
  sweep.down([&](std::size_t t) {
    const FrontFactor& f = fronts_[t];
    const std::size_t n = f.ids.size(), k = f.pivots.count;
    std::vector<Number> x(n);
    for (std::size_t r = 0; r < n; ++r) x[r] = y[f.ids[r]];
    dense::subtract_transposed_product(k, 1, n - k, f.lower.data() + k, n, x.data() + k, n, x.data(), n);
    dense::solve_lower_transposed(k, 1, f.lower.data(), n, x.data(), n, true);
    for (std::size_t p = 0; p < k; ++p) y[f.ids[p]] = x[p];
  });
}

template <typename Number>
double LdltFactor<Number>::solve_work(std::size_t t) const {
  return static_cast<double>(fronts_[t].pivots.count * fronts_[t].ids.size() + 100);
}

template class LdltFactor<double>;
template class LdltFactor<std::complex<double>>;

}  // namespace equidem
