// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/linear/multigrid/kernels/grid_kernel.hpp"

#include <cstring>

#include "equidem/core/simd.hpp"

namespace equidem::multigrid {
namespace {

struct Loops {
  static EQUIDEM_ALWAYS_INLINE void restrict_cell(const PointsOfCell& points, const Quad* forces, Quad* corners) {
    Quad sums[4] = {};
    for (std::size_t k = 0; k < points.count; ++k) {
      const auto [s, t] = points.inside[k];
      const Quad force = forces[k];
      const float across = points.half_y * t * (1 - t) * force[0], along = points.half_x * s * (1 - s) * force[1];
      sums[0] += (1 - t) * ((1 - s) * force) + Quad{0, 0, (1 - t) * along - (1 - s) * across, 0};
      sums[1] += (1 - t) * (s * force) + Quad{0, 0, -(1 - t) * along - s * across, 0};
      sums[2] += t * ((1 - s) * force) + Quad{0, 0, t * along + (1 - s) * across, 0};
      sums[3] += t * (s * force) + Quad{0, 0, s * across - t * along, 0};
    }
    std::memcpy(corners, sums, sizeof sums);
  }

  static EQUIDEM_ALWAYS_INLINE void move_points(const PointsOfCell& points, const Quad* corners, Quad* motions) {
    const Quad u = corners[0], along_x = corners[1] - u, along_y = corners[2] - u;
    const Quad twist = corners[3] - corners[1] - along_y;
    for (std::size_t k = 0; k < points.count; ++k) {
      const auto [s, t] = points.inside[k];
      const Quad linked{points.half_y * t * (1 - t) * (along_y[2] + s * twist[2]),
                        -points.half_x * s * (1 - s) * (along_x[2] + t * twist[2]), 0, 0};
      motions[k] += u + s * along_x + t * (along_y + s * twist) + linked;
    }
  }

  using Four = simd::Four;

  static EQUIDEM_ALWAYS_INLINE void add_squares(double k, const double* v, double l, const double* w, double* matrix) {
    for (int part = 0; part < 12; part += 4) {
      const Four kv = k * simd::load<Four>(v + part), lw = l * simd::load<Four>(w + part);
      for (int r = 0; r < 12; ++r) {
        double* const row = matrix + 12 * r + part;
        simd::store(simd::load<Four>(row) + (v[r] * kv + w[r] * lw), row);
      }
    }
  }

  static EQUIDEM_ALWAYS_INLINE void add_projection(const double* k, const double* t, double* matrix) {
    double product[144];  // K T
    for (int r = 0; r < 12; ++r) {
      Four sums[3] = {};
      for (int c = 0; c < 12; ++c) {
        for (int part = 0; part < 3; ++part) sums[part] += k[12 * r + c] * simd::load<Four>(t + 12 * c + 4 * part);
      }
      for (int part = 0; part < 3; ++part) simd::store(sums[part], product + 12 * r + 4 * part);
    }
    for (int r = 0; r < 12; ++r) {
      Four sums[3];
      for (int part = 0; part < 3; ++part) sums[part] = simd::load<Four>(matrix + 12 * r + 4 * part);
      for (int c = 0; c < 12; ++c) {
        for (int part = 0; part < 3; ++part)
          sums[part] += t[12 * c + r] * simd::load<Four>(product + 12 * c + 4 * part);
      }
      for (int part = 0; part < 3; ++part) simd::store(sums[part], matrix + 12 * r + 4 * part);
    }
  }
};

/// The loops compiled for vectors of one width.
#define EQUIDEM_LOOPS(name, attributes)                                                                        \
  struct name {                                                                                                \
    attributes static void restrict_cell(const PointsOfCell& points, const Quad* force, Quad* corners) {       \
      Loops::restrict_cell(points, force, corners);                                                            \
    }                                                                                                          \
    attributes static void move_points(const PointsOfCell& points, const Quad* corners, Quad* motion) {        \
      Loops::move_points(points, corners, motion);                                                             \
    }                                                                                                          \
    attributes static void add_squares(double k, const double* v, double l, const double* w, double* matrix) { \
      Loops::add_squares(k, v, l, w, matrix);                                                                  \
    }                                                                                                          \
    attributes static void add_projection(const double* k, const double* t, double* matrix) {                  \
      Loops::add_projection(k, t, matrix);                                                                     \
    }                                                                                                          \
    static constexpr GridFunctions all = {&restrict_cell, &move_points, &add_squares, &add_projection};        \
  }

EQUIDEM_LOOPS(PlainLoops, );
#if defined(__x86_64__)
EQUIDEM_LOOPS(WideLoops, __attribute__((target("avx2,fma"))));
#endif

}  // namespace

const GridFunctions& grid_functions() {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return WideLoops::all;
#endif
  return PlainLoops::all;
}

}  // namespace equidem::multigrid
