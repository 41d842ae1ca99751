// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/waves/lanczos.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "equidem/core/ordered_sums.hpp"
#include "equidem/core/progress.hpp"
#include "equidem/core/random.hpp"
#include "equidem/core/threads.hpp"
#include "equidem/linear/multifrontal/dense_kernels.hpp"

namespace equidem {
namespace {

using Product = std::function<void(std::span<const double>, std::span<double>)>;

constexpr std::size_t rows_of_loop = 1 << 13;
constexpr double rounding = 0x1.0p-51;

template <typename Function>
void for_rows(std::size_t size, const Function& f) {
  parallel_ranges(size, rows_of_loop, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) f(k);
  });
}
template <typename Function>
double sum_over_rows(std::size_t size, const Function& f) {
  return sums_over<1>(size, rows_of_loop, [&](std::size_t begin, std::size_t end) {
    double sum = 0;
    for (std::size_t k = begin; k < end; ++k) sum += f(k);
    return std::array{sum};
  })[0];
}

/// A/scale or, for the lowest eigenvalue, -A/scale; scaled to about 1, since squares are taken.
struct Operator {
  const Product& multiply;
  double scale;  // negative for the lowest
};

std::vector<double> starting_vector(std::size_t size, std::uint64_t seed) {
  Random random(seed);
  std::vector<double> x(size);
  for (double& value : x) value = random.uniform(-1, 1);
  return x;
}

/// The matrix of the process: diagonal[k], and beside[k] between k and k + 1; the last of them leads out of it.
struct Tridiagonal {
  std::vector<double> diagonal, beside;
  double norm = 0;  ///< upper bound of the sizes of its eigenvalues

  void add(double on_diagonal, double next) {
    norm = std::max(norm, std::abs(on_diagonal) + next + (beside.empty() ? 0 : beside.back()));
    diagonal.push_back(on_diagonal);
    beside.push_back(next);
  }
};

/// The largest eigenvalue of the matrix by bisection, from above.
double largest_eigenvalue(const Tridiagonal& t) {
  const auto above_all = [&](double value) {
    double pivot = t.diagonal[0] - value;
    for (std::size_t k = 1; k < t.diagonal.size() && pivot < 0; ++k) {
      pivot = t.diagonal[k] - value - t.beside[k - 1] * t.beside[k - 1] / pivot;
    }
    return pivot < 0;
  };
  double low = *std::ranges::max_element(t.diagonal), high = (1 + 1e-14) * t.norm;
  while (true) {
    const double middle = low + 0.5 * (high - low);
    if (!(middle > low && middle < high)) return high;
    (above_all(middle) ? high : low) = middle;
  }
}

/// The last component of the unit eigenvector of the largest eigenvalue, by a twisted factorization, which gives small
/// components to all their digits (Dhillon & Parlett 2004).
double last_of_eigenvector(const Tridiagonal& t, double value) {
  const std::size_t n = t.diagonal.size();
  constexpr double least = 1e-300;
  const auto pivot = [&](double p) { return p < -least ? p : -least; };
  std::vector<double> down(n), up(n), x(n);
  for (std::size_t k = 0; k < n; ++k) {
    const double rest = k > 0 ? t.beside[k - 1] * t.beside[k - 1] / down[k - 1] : 0;
    down[k] = pivot(t.diagonal[k] - value - rest);
  }
  for (std::size_t k = n; k-- > 0;) {
    const double rest = k + 1 < n ? t.beside[k] * t.beside[k] / up[k + 1] : 0;
    up[k] = pivot(t.diagonal[k] - value - rest);
  }
  std::size_t twist = 0;
  double smallest = 0;
  for (std::size_t k = 0; k < n; ++k) {
    const double gamma = std::abs(down[k] + up[k] - (t.diagonal[k] - value));
    if (k == 0 || gamma < smallest) smallest = gamma, twist = k;
  }
  x[twist] = 1;
  for (std::size_t k = twist; k-- > 0;) x[k] = -t.beside[k] * x[k + 1] / down[k];
  for (std::size_t k = twist + 1; k < n; ++k) x[k] = -t.beside[k - 1] * x[k - 1] / up[k];
  double square = 0;
  for (const double component : x) square += component * component;
  return x.back() / std::sqrt(square);
}

/// The vectors of the three-term recurrence.
class Recurrence {
 public:
  Recurrence(const Operator& a, std::vector<double> start)
      : a_(a), v_(std::move(start)), before_(v_.size()), w_(v_.size()) {
    const double size = std::sqrt(sum_over_rows(v_.size(), [&](std::size_t k) { return v_[k] * v_[k]; }));
    for_rows(v_.size(), [&](std::size_t k) { v_[k] /= size; });
  }

  /// Adds a row to the matrix.
  void step(Tridiagonal& t) {
    multiply();
    const double diagonal = sum_over_rows(v_.size(), [&](std::size_t k) { return v_[k] * w_[k]; });
    const double last = t.beside.empty() ? 0 : t.beside.back();
    const double beside = std::sqrt(sum_over_rows(v_.size(), [&](std::size_t k) {
      w_[k] -= diagonal * v_[k] + last * before_[k];
      return w_[k] * w_[k];
    }));
    t.add(diagonal, beside);
    advance(beside);
  }

 private:
  void multiply() {
    stop_if_interrupted();
    a_.multiply(v_, w_);
    for_rows(w_.size(), [&](std::size_t k) { w_[k] /= a_.scale; });
  }
  void advance(double beside) {
    std::swap(before_, v_);
    std::swap(v_, w_);
    if (beside > 0) for_rows(v_.size(), [&](std::size_t k) { v_[k] /= beside; });
  }

  const Operator& a_;
  std::vector<double> v_, before_, w_;
};

/// Small enough for the whole spectrum.
void solve_dense(const Operator& a, std::size_t size, ExtremeEigenvalue& result) {
  std::vector<double> matrix(size * size), values(size), unit(size, 0.0);
  for (std::size_t k = 0; k < size; ++k) {
    unit[k] = 1;
    a.multiply(unit, {&matrix[k * size], size});
    unit[k] = 0;
  }
  for (double& entry : matrix) entry /= a.scale;
  result.products = static_cast<std::int64_t>(size);
  const dense::OneThreadPerCall one_thread;
  result.converged = dense::find_spectrum(size, matrix.data(), values.data(), false) == 0;
  result.value = values.back();
  result.residual = rounding * static_cast<double>(size) * std::max(std::abs(values.front()), std::abs(values.back()));
}

void iterate(const Operator& a, std::vector<double> start, const LanczosOptions& options, ExtremeEigenvalue& result) {
  const auto most = static_cast<std::size_t>(std::max(2000.0, options.work / static_cast<double>(start.size())));
  Tridiagonal t;
  Recurrence vectors(a, std::move(start));
  for (std::size_t next = 10;;) {
    vectors.step(t);
    const std::size_t steps = t.diagonal.size();
    const bool ends = steps == most || t.beside.back() <= rounding * t.norm;
    if (steps < next && !ends) continue;
    next = steps + std::max<std::size_t>(5, steps / 20);
    result.value = largest_eigenvalue(t);
    result.residual = t.beside.back() * std::abs(last_of_eigenvector(t, result.value)) + rounding * t.norm;
    result.products = static_cast<std::int64_t>(steps);
    result.converged = result.residual <= options.tolerance * std::abs(result.value);
    if (ends || result.converged) return;
  }
}

}  // namespace

ExtremeEigenvalue extreme_eigenvalue(std::size_t size, const Product& multiply, SpectrumEnd end,
                                     const LanczosOptions& options) {
  ExtremeEigenvalue result;
  if (size == 0) return result;
  const std::vector<double> start = starting_vector(size, options.seed);
  std::vector<double> y(size);
  multiply(start, y);
  double scale = 0;
  for (const double component : y) scale = std::max(scale, std::abs(component));
  result.converged = scale == 0;  // nothing resists anything
  if (result.converged) return result;
  const Operator a{multiply, end == SpectrumEnd::largest ? scale : -scale};
  constexpr std::size_t dense_limit = 60;
  if (size <= dense_limit) {
    solve_dense(a, size, result);
  } else {
    iterate(a, start, options, result);
  }
  ++result.products;
  result.value *= a.scale;
  result.residual *= scale;
  return result;
}

}  // namespace equidem
