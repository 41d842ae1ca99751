// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/linear/kernels/panel_solve.hpp"

#include <cstring>

#define EQUIDEM_INLINE inline __attribute__((always_inline))

namespace equidem {
namespace {

/// 32 bytes of numbers: two vectors where the processor has only those of 16.
template <typename Real>
struct Lanes;
template <>
struct Lanes<float> {
  typedef float Vector __attribute__((vector_size(32)));  // NOLINT(modernize-use-using): attribute of a typedef
};
template <>
struct Lanes<double> {
  typedef double Vector __attribute__((vector_size(32)));  // NOLINT(modernize-use-using)
};

template <typename Real>
using Vector = typename Lanes<Real>::Vector;
template <typename Real>
constexpr std::size_t width = 32 / sizeof(Real);

template <typename Real>
EQUIDEM_INLINE Vector<Real> load(const Real* from) {
  Vector<Real> v;
  std::memcpy(&v, from, sizeof v);
  return v;
}

template <typename Real>
EQUIDEM_INLINE void store(Real* to, const Vector<Real>& v) {
  std::memcpy(to, &v, sizeof v);
}

template <typename Real>
EQUIDEM_INLINE Real sum(const Vector<Real>& v) {
  Real total = 0;
  for (std::size_t e = 0; e < width<Real>; ++e) total += v[e];
  return total;
}

/// Pivots [p, p + N) of L y = b for C columns w of `rows` numbers.
template <typename Real, std::size_t N, std::size_t C>
EQUIDEM_INLINE void eliminate(const Panel<Real>& panel, std::size_t p, Real* w) {
  const std::size_t ld = panel.rows;
  const Real* a = panel.values + p * ld;
  Real y[C][N];
  for (std::size_t c = 0; c < C; ++c) {
    Real* column = w + c * ld + p;
    for (std::size_t j = 0; j < N; ++j) {
      Real value = column[j];
      for (std::size_t i = 0; i < j; ++i) value -= a[i * ld + p + j] * y[c][i];
      column[j] = y[c][j] = value / a[j * ld + p + j];
    }
  }
  std::size_t r = p + N;
  for (; r + width<Real> <= ld; r += width<Real>) {
    Vector<Real> l[N];
    for (std::size_t j = 0; j < N; ++j) {
      l[j] = load(a + j * ld + r);
      __builtin_prefetch(a + (j + 2 * N) * ld + r);
    }
    for (std::size_t c = 0; c < C; ++c) {
      Vector<Real> v = load(w + c * ld + r);
      for (std::size_t j = 0; j < N; ++j) v -= l[j] * y[c][j];
      store(w + c * ld + r, v);
    }
  }
  for (; r < ld; ++r) {
    for (std::size_t c = 0; c < C; ++c) {
      for (std::size_t j = 0; j < N; ++j) w[c * ld + r] -= a[j * ld + r] * y[c][j];
    }
  }
}

/// Pivots [p, p + N) of L^T x = y.
template <typename Real, std::size_t N, std::size_t C>
EQUIDEM_INLINE void substitute(const Panel<Real>& panel, std::size_t p, Real* w) {
  const std::size_t ld = panel.rows;
  const Real* a = panel.values + p * ld;
  Vector<Real> sums[C][N] = {};
  std::size_t r = p + N;
  for (; r + width<Real> <= ld; r += width<Real>) {
    Vector<Real> l[N];
    for (std::size_t j = 0; j < N; ++j) {
      l[j] = load(a + j * ld + r);
      __builtin_prefetch(a + j * ld + r - 2 * N * ld);
    }
    for (std::size_t c = 0; c < C; ++c) {
      const Vector<Real> v = load(w + c * ld + r);
      for (std::size_t j = 0; j < N; ++j) sums[c][j] += l[j] * v;
    }
  }
  for (std::size_t c = 0; c < C; ++c) {
    Real* column = w + c * ld;
    for (std::size_t j = N; j-- > 0;) {
      Real value = column[p + j] - sum<Real>(sums[c][j]);
      for (std::size_t s = r; s < ld; ++s) value -= a[j * ld + s] * column[s];
      for (std::size_t i = j + 1; i < N; ++i) value -= a[j * ld + p + i] * column[p + i];
      column[p + j] = value / a[j * ld + p + j];
    }
  }
}

constexpr std::size_t at_once = 4;  // pivots

template <typename Real, std::size_t C>
EQUIDEM_INLINE void forward(const Panel<Real>& panel, Real* w) {
  std::size_t p = 0;
  for (; p + at_once <= panel.pivots; p += at_once) eliminate<Real, at_once, C>(panel, p, w);
  for (; p < panel.pivots; ++p) eliminate<Real, 1, C>(panel, p, w);
}

template <typename Real, std::size_t C>
EQUIDEM_INLINE void backward(const Panel<Real>& panel, Real* w) {
  std::size_t p = panel.pivots;
  for (; p % at_once != 0; --p) substitute<Real, 1, C>(panel, p - 1, w);
  for (; p > 0; p -= at_once) substitute<Real, at_once, C>(panel, p - at_once, w);
}

template <typename Real>
EQUIDEM_INLINE void solve(bool up, const Panel<Real>& panel, Real* w, std::size_t columns) {
  switch (columns) {
    case 1:
      return up ? forward<Real, 1>(panel, w) : backward<Real, 1>(panel, w);
    case 2:
      return up ? forward<Real, 2>(panel, w) : backward<Real, 2>(panel, w);
    case 3:
      return up ? forward<Real, 3>(panel, w) : backward<Real, 3>(panel, w);
    case 4:
      return up ? forward<Real, 4>(panel, w) : backward<Real, 4>(panel, w);
  }
}

template <typename Real>
void solve_plain(bool up, const Panel<Real>& panel, Real* w, std::size_t columns) {
  solve(up, panel, w, columns);
}

#if defined(__x86_64__)
template <typename Real>
__attribute__((target("avx2,fma"))) void solve_wide(bool up, const Panel<Real>& panel, Real* w, std::size_t columns) {
  solve(up, panel, w, columns);
}
#endif

template <typename Real>
void solve_by_processor(bool up, const Panel<Real>& panel, Real* w, std::size_t columns) {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return solve_wide(up, panel, w, columns);
#endif
  solve_plain(up, panel, w, columns);
}

}  // namespace

template <typename Real>
void solve_forward(const Panel<Real>& panel, Real* w, std::size_t columns) {
  solve_by_processor(true, panel, w, columns);
}

template <typename Real>
void solve_backward(const Panel<Real>& panel, Real* w, std::size_t columns) {
  solve_by_processor(false, panel, w, columns);
}

template void solve_forward<float>(const Panel<float>&, float*, std::size_t);
template void solve_forward<double>(const Panel<double>&, double*, std::size_t);
template void solve_backward<float>(const Panel<float>&, float*, std::size_t);
template void solve_backward<double>(const Panel<double>&, double*, std::size_t);

}  // namespace equidem
