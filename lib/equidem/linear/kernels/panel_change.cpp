// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/linear/kernels/panel_change.hpp"

#include <cmath>

#include "equidem/core/simd.hpp"
#include "equidem/linear/kernels/panel_solve.hpp"

namespace equidem {
namespace {

constexpr std::size_t width = sizeof(PanelLanes) / sizeof(double);

/// A vector w of sign +-1 and a column l of L: l := shrink l + lift w, then w := grow w - part l.
struct Turn {
  double shrink = 1, lift = 0, grow = 1, part = 0;
};

/// The turn at a pivot, which becomes the new one.
EQUIDEM_ALWAYS_INLINE Turn turn_at(double& pivot, double w, double sign, double stiffness, double least, bool& vanished,
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
EQUIDEM_ALWAYS_INLINE void change_pivots(const PanelChange& change, std::size_t p, PanelChangeResult& result) {
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
EQUIDEM_ALWAYS_INLINE void change_all(const PanelChange& change, PanelChangeResult& result) {
  constexpr std::size_t at_once = 4;  // pivots
  std::size_t p = 0;
  for (; p + at_once <= change.pivots; p += at_once) change_pivots<at_once, K, C>(change, p, result);
  for (; p < change.pivots; ++p) change_pivots<1, K, C>(change, p, result);
}

template <std::size_t K>
EQUIDEM_ALWAYS_INLINE void change_with(const PanelChange& change, PanelChangeResult& result) {
  switch (change.right_sides) {
    case 0:
      return change_all<K, 0>(change, result);
    case 1:
      return change_all<K, 1>(change, result);
    case 2:
      return change_all<K, 2>(change, result);
  }
}

EQUIDEM_ALWAYS_INLINE void change_by(const PanelChange& change, PanelChangeResult& result) {
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
