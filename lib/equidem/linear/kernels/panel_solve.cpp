// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/linear/kernels/panel_solve.hpp"

#include <array>
#include <cstdint>
#include <cstring>

#include "equidem/core/simd.hpp"

namespace equidem {
namespace {

using Vector = PanelLanes;
constexpr std::size_t width = 4;

/// Sums over the lanes of each of N vectors.
template <std::size_t N>
struct LaneSums {
  Vector all;

  EQUIDEM_ALWAYS_INLINE explicit LaneSums(const Vector (&given)[N]) {
    Vector v[4] = {};
    for (std::size_t j = 0; j < N; ++j) v[j] = given[j];
    const auto low = __builtin_shufflevector(v[0], v[1], 0, 4, 2, 6) + __builtin_shufflevector(v[0], v[1], 1, 5, 3, 7);
    const auto high = __builtin_shufflevector(v[2], v[3], 0, 4, 2, 6) + __builtin_shufflevector(v[2], v[3], 1, 5, 3, 7);
    all = __builtin_shufflevector(low, high, 0, 1, 4, 5) + __builtin_shufflevector(low, high, 2, 3, 6, 7);
  }
  EQUIDEM_ALWAYS_INLINE double operator[](std::size_t j) const { return all[j]; }
};

/// The last `count` numbers of a vector, < width; 0 before them, whatever stands there.
EQUIDEM_ALWAYS_INLINE Vector load_last(const double* end, std::size_t count) {
  typedef std::int64_t Mask __attribute__((vector_size(32)));  // NOLINT(modernize-use-using)
  static constexpr auto masks = [] {
    std::array<std::int64_t, 2 * width> all{};
    for (std::size_t e = width; e < all.size(); ++e) all[e] = -1;
    return all;
  }();
  Mask mask, bits;
  std::memcpy(&mask, masks.data() + count, sizeof mask);
  std::memcpy(&bits, end - width, sizeof bits);
  return reinterpret_cast<Vector>(bits & mask);
}

/// Pivots [p, p + N) of L y = b for C columns w of `rows` numbers.
template <std::size_t N, std::size_t C>
EQUIDEM_ALWAYS_INLINE void eliminate(const Panel& panel, std::size_t p, double* w) {
  const std::size_t ld = panel.rows;
  const double* a = panel.values + p * ld;
  double y[C][N];
  for (std::size_t c = 0; c < C; ++c) {
    double* column = w + c * ld + p;
    for (std::size_t j = 0; j < N; ++j) {
      double value = column[j];
      for (std::size_t i = 0; i < j; ++i) value -= a[i * ld + p + j] * y[c][i];
      column[j] = y[c][j] = value / a[j * ld + p + j];
    }
  }
  std::size_t r = p + N;
  for (; r + width <= ld; r += width) {
    Vector l[N];
    for (std::size_t j = 0; j < N; ++j) {
      l[j] = load_lanes(a + j * ld + r);
      __builtin_prefetch(a + (j + 2 * N) * ld + r);
    }
    for (std::size_t c = 0; c < C; ++c) {
      Vector v = load_lanes(w + c * ld + r);
      for (std::size_t j = 0; j < N; ++j) v -= l[j] * y[c][j];
      store_lanes(w + c * ld + r, v);
    }
  }
  for (; r < ld; ++r) {
    for (std::size_t c = 0; c < C; ++c) {
      for (std::size_t j = 0; j < N; ++j) w[c * ld + r] -= a[j * ld + r] * y[c][j];
    }
  }
}

/// Pivots [p, p + N) of L^T x = y. \param before the solutions of the next `width` rows where they have just been
/// found: the sums over other rows do not wait for them; null: they are read
template <std::size_t N, std::size_t C>
EQUIDEM_ALWAYS_INLINE void substitute(const Panel& panel, std::size_t p, double* w, const Vector* before,
                                      Vector* found) {
  const std::size_t ld = panel.rows;
  const double* a = panel.values + p * ld;
  double inverse[N], triangle[N][N];  // 1/l_jj and l_ij/l_jj: neither they nor divisions wait for solutions
  for (std::size_t j = 0; j < N; ++j) {
    inverse[j] = 1 / a[j * ld + p + j];
    for (std::size_t i = j + 1; i < N; ++i) triangle[j][i] = a[j * ld + p + i] * inverse[j];
  }
  Vector sums[C][N] = {};
  const std::size_t first = p + N;
  std::size_t r = before != nullptr ? first + width : first;
  for (; r + width <= ld; r += width) {
    Vector l[N];
    for (std::size_t j = 0; j < N; ++j) {
      l[j] = load_lanes(a + j * ld + r);
      __builtin_prefetch(a + j * ld + r - 2 * N * ld);
    }
    for (std::size_t c = 0; c < C; ++c) {
      const Vector v = load_lanes(w + c * ld + r);
      for (std::size_t j = 0; j < N; ++j) sums[c][j] += l[j] * v;
    }
  }
  if (r < ld && ld >= width) {
    for (std::size_t c = 0; c < C; ++c) {
      const Vector v = load_last(w + (c + 1) * ld, ld - r);
      for (std::size_t j = 0; j < N; ++j) sums[c][j] += load_last(a + (j + 1) * ld, ld - r) * v;
    }
    r = ld;
  }
  if (before != nullptr) {
    for (std::size_t j = 0; j < N; ++j) {
      const Vector l = load_lanes(a + j * ld + first);
      for (std::size_t c = 0; c < C; ++c) sums[c][j] += l * before[c];
    }
  }
  for (std::size_t c = 0; c < C; ++c) {
    double* column = w + c * ld;
    const LaneSums<N> below(sums[c]);
    double x[N];
    for (std::size_t j = 0; j < N; ++j) {
      x[j] = column[p + j] - below[j];
      for (std::size_t s = r; s < ld; ++s) x[j] -= a[j * ld + s] * column[s];
      x[j] *= inverse[j];
    }
    for (std::size_t i = N; i-- > 1;) {
      for (std::size_t j = 0; j < i; ++j) x[j] -= triangle[j][i] * x[i];
    }
    if constexpr (N == width) {
      for (std::size_t j = 0; j < N; ++j) found[c][j] = x[j];
      store_lanes(column + p, found[c]);
    } else {
      for (std::size_t j = 0; j < N; ++j) column[p + j] = x[j];
    }
  }
}

constexpr std::size_t at_once = 4;  // pivots

template <std::size_t C>
EQUIDEM_ALWAYS_INLINE void forward(const Panel& panel, double* w) {
  std::size_t p = 0;
  for (; p + at_once <= panel.pivots; p += at_once) eliminate<at_once, C>(panel, p, w);
  for (; p < panel.pivots; ++p) eliminate<1, C>(panel, p, w);
}

template <std::size_t C>
EQUIDEM_ALWAYS_INLINE void backward(const Panel& panel, double* w) {
  Vector found[C];
  const Vector* before = nullptr;
  std::size_t p = panel.pivots;
  while (p >= at_once) {
    p -= at_once;
    substitute<at_once, C>(panel, p, w, before, found);
    if (at_once == width) before = found;
  }
  switch (p) {
    case 3:
      return substitute<3, C>(panel, 0, w, before, found);
    case 2:
      return substitute<2, C>(panel, 0, w, before, found);
    case 1:
      return substitute<1, C>(panel, 0, w, before, found);
  }
}

EQUIDEM_ALWAYS_INLINE void solve(bool up, const Panel& panel, double* w, std::size_t columns) {
  switch (columns) {
    case 1:
      return up ? forward<1>(panel, w) : backward<1>(panel, w);
    case 2:
      return up ? forward<2>(panel, w) : backward<2>(panel, w);
    case 3:
      return up ? forward<3>(panel, w) : backward<3>(panel, w);
    case 4:
      return up ? forward<4>(panel, w) : backward<4>(panel, w);
  }
}

#if defined(__x86_64__)
__attribute__((target("avx2,fma"))) void solve_wide(bool up, const Panel& panel, double* w, std::size_t columns) {
  solve(up, panel, w, columns);
}
#endif

void solve_by_processor(bool up, const Panel& panel, double* w, std::size_t columns) {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return solve_wide(up, panel, w, columns);
#endif
  solve(up, panel, w, columns);
}

}  // namespace

void solve_forward(const Panel& panel, double* w, std::size_t columns) {
  solve_by_processor(true, panel, w, columns);
}

void solve_backward(const Panel& panel, double* w, std::size_t columns) {
  solve_by_processor(false, panel, w, columns);
}

}  // namespace equidem
