// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/linear/kernels/panel_solve.hpp"

#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>

#define EQUIDEM_INLINE inline __attribute__((always_inline))

namespace equidem {
namespace {

constexpr std::size_t width = sizeof(PanelLanes) / sizeof(double);

/// A vector w of sign +-1 and a column l of L: l := shrink l + lift w, then w := grow w - part l.
struct Turn {
  double shrink = 1, lift = 0, grow = 1, part = 0;
};

/// The turn at a pivot, which becomes the new one.
EQUIDEM_INLINE Turn turn_at(double& pivot, double w, double sign, double stiffness, double least, bool& vanished,
                            double& share) {
  const double square = sign > 0 ? pivot * pivot + w * w : (pivot - w) * (pivot + w);
  if (sign < 0 && !(square > least * stiffness)) {
    vanished = true;
    pivot = std::sqrt(stiffness);
    return {0, 0, 0, 0};
  }
  const double root = std::sqrt(square);
  const Turn turn{pivot / root, sign * w / root, root / pivot, w / pivot};
  share *= turn.grow * turn.grow;
  pivot = root;
  return turn;
}

/// Pivots [p, p + N) with K vectors and C right-hand sides.
template <std::size_t N, std::size_t K, std::size_t C>
EQUIDEM_INLINE void change_pivots(const PanelChange& change, std::size_t p, PanelChangeResult& result) {
  const std::size_t ld = change.rows;
  double* a = change.values + p * ld;
  double* const w = change.vectors;
  double* const b = change.right;
  Turn turns[N][K];
  double y[N][C + 1];
  for (std::size_t j = 0; j < N; ++j) {
    double& pivot = a[j * ld + p + j];
    for (std::size_t k = 0; k < K; ++k) {
      bool vanished = false;
      turns[j][k] = turn_at(pivot, w[k * ld + p + j], change.signs[k], change.stiffness[p + j], change.least, vanished,
                            result.share);
      if (vanished) result.vanished.push_back(p + j);
    }
    for (std::size_t c = 0; c < C; ++c) y[j][c] = b[c * ld + p + j] /= pivot;
    for (std::size_t i = p + j + 1; i < p + N; ++i) {
      double l = a[j * ld + i];
      for (std::size_t k = 0; k < K; ++k) {
        const Turn& turn = turns[j][k];
        double& v = w[k * ld + i];
        l = turn.shrink * l + turn.lift * v;
        v = turn.grow * v - turn.part * l;
      }
      a[j * ld + i] = l;
      for (std::size_t c = 0; c < C; ++c) b[c * ld + i] -= l * y[j][c];
    }
  }
  std::size_t r = p + N;
  for (; r + width <= ld; r += width) {
    PanelLanes v[K], right[C + 1];
    for (std::size_t k = 0; k < K; ++k) v[k] = load_lanes(w + k * ld + r);
    for (std::size_t c = 0; c < C; ++c) right[c] = load_lanes(b + c * ld + r);
    for (std::size_t j = 0; j < N; ++j) {
      PanelLanes l = load_lanes(a + j * ld + r);
      __builtin_prefetch(a + (j + 2 * N) * ld + r, 1);
      for (std::size_t k = 0; k < K; ++k) {
        const Turn& turn = turns[j][k];
        l = turn.shrink * l + turn.lift * v[k];
        v[k] = turn.grow * v[k] - turn.part * l;
      }
      store_lanes(a + j * ld + r, l);
      for (std::size_t c = 0; c < C; ++c) right[c] -= l * y[j][c];
    }
    for (std::size_t k = 0; k < K; ++k) store_lanes(w + k * ld + r, v[k]);
    for (std::size_t c = 0; c < C; ++c) store_lanes(b + c * ld + r, right[c]);
  }
  for (; r < ld; ++r) {
    for (std::size_t j = 0; j < N; ++j) {
      double l = a[j * ld + r];
      for (std::size_t k = 0; k < K; ++k) {
        const Turn& turn = turns[j][k];
        double& v = w[k * ld + r];
        l = turn.shrink * l + turn.lift * v;
        v = turn.grow * v - turn.part * l;
      }
      a[j * ld + r] = l;
      for (std::size_t c = 0; c < C; ++c) b[c * ld + r] -= l * y[j][c];
    }
  }
}

template <std::size_t K, std::size_t C>
EQUIDEM_INLINE void change_all(const PanelChange& change, PanelChangeResult& result) {
  constexpr std::size_t at_once = 4;  // pivots
  std::size_t p = 0;
  for (; p + at_once <= change.pivots; p += at_once) change_pivots<at_once, K, C>(change, p, result);
  for (; p < change.pivots; ++p) change_pivots<1, K, C>(change, p, result);
}

template <std::size_t K>
EQUIDEM_INLINE void change_with(const PanelChange& change, PanelChangeResult& result) {
  switch (change.right_sides) {
    case 0:
      return change_all<K, 0>(change, result);
    case 1:
      return change_all<K, 1>(change, result);
    case 2:
      return change_all<K, 2>(change, result);
  }
}

EQUIDEM_INLINE void change_by(const PanelChange& change, PanelChangeResult& result) {
  if (change.changes == 1) return change_with<1>(change, result);
  change_with<2>(change, result);
}

#if defined(__x86_64__)
__attribute__((target("avx2,fma"))) void change_wide(const PanelChange& change, PanelChangeResult& result) {
  change_by(change, result);
}
#endif

}  // namespace

void change_panel(const PanelChange& change, PanelChangeResult& result) {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return change_wide(change, result);
#endif
  change_by(change, result);
}

}  // namespace equidem

#define EQUIDEM_INLINE inline __attribute__((always_inline))

namespace equidem {
namespace {

using Vector = PanelLanes;
constexpr std::size_t width = 4;

/// Sums over the lanes of each of N vectors.
template <std::size_t N>
struct LaneSums {
  Vector all;

  EQUIDEM_INLINE explicit LaneSums(const Vector (&given)[N]) {
    Vector v[4] = {};
    for (std::size_t j = 0; j < N; ++j) v[j] = given[j];
    const auto low = __builtin_shufflevector(v[0], v[1], 0, 4, 2, 6) + __builtin_shufflevector(v[0], v[1], 1, 5, 3, 7);
    const auto high = __builtin_shufflevector(v[2], v[3], 0, 4, 2, 6) + __builtin_shufflevector(v[2], v[3], 1, 5, 3, 7);
    all = __builtin_shufflevector(low, high, 0, 1, 4, 5) + __builtin_shufflevector(low, high, 2, 3, 6, 7);
  }
  EQUIDEM_INLINE double operator[](std::size_t j) const { return all[j]; }
};

/// The last `count` numbers of a vector, < width; 0 before them, whatever stands there.
EQUIDEM_INLINE Vector load_last(const double* end, std::size_t count) {
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
EQUIDEM_INLINE void eliminate(const Panel& panel, std::size_t p, double* w) {
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
EQUIDEM_INLINE void substitute(const Panel& panel, std::size_t p, double* w, const Vector* before, Vector* found) {
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
EQUIDEM_INLINE void forward(const Panel& panel, double* w) {
  std::size_t p = 0;
  for (; p + at_once <= panel.pivots; p += at_once) eliminate<at_once, C>(panel, p, w);
  for (; p < panel.pivots; ++p) eliminate<1, C>(panel, p, w);
}

template <std::size_t C>
EQUIDEM_INLINE void backward(const Panel& panel, double* w) {
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

EQUIDEM_INLINE void solve(bool up, const Panel& panel, double* w, std::size_t columns) {
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
