// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/linear/multigrid/kernels/row_kernel.hpp"

#include <array>
#include <cstdint>
#include <cstring>
#include <utility>

#include "equidem/core/simd.hpp"

namespace equidem::multigrid {
namespace {

constexpr int lanes = GroupedRows::lanes;

using Singles = float __attribute__((vector_size(32)));
using Doubles = simd::Four;

template <class Lanes>
EQUIDEM_ALWAYS_INLINE void load(const float* from, Lanes& to) {
  if constexpr (sizeof(to[0]) == sizeof(float)) {
    std::memcpy(&to, from, sizeof to);
  } else {
    Quad four;
    std::memcpy(&four, from, sizeof four);
    to = __builtin_convertvector(four, Lanes);
  }
}

/// x, y and turn of several rows.
template <class Lanes>
struct Motions {
  Lanes x, y, turn;
};

/// Rows of four numbers, eight of them, as columns.
EQUIDEM_ALWAYS_INLINE void gather(const Quad* motion, const std::int32_t* row, Motions<Singles>& to) {
  const Singles a = __builtin_shufflevector(motion[row[0]], motion[row[4]], 0, 1, 2, 3, 4, 5, 6, 7);
  const Singles b = __builtin_shufflevector(motion[row[1]], motion[row[5]], 0, 1, 2, 3, 4, 5, 6, 7);
  const Singles c = __builtin_shufflevector(motion[row[2]], motion[row[6]], 0, 1, 2, 3, 4, 5, 6, 7);
  const Singles d = __builtin_shufflevector(motion[row[3]], motion[row[7]], 0, 1, 2, 3, 4, 5, 6, 7);
  const Singles xy_ab = __builtin_shufflevector(a, b, 0, 8, 1, 9, 4, 12, 5, 13);
  const Singles xy_cd = __builtin_shufflevector(c, d, 0, 8, 1, 9, 4, 12, 5, 13);
  const Singles turn_ab = __builtin_shufflevector(a, b, 2, 10, 3, 11, 6, 14, 7, 15);
  const Singles turn_cd = __builtin_shufflevector(c, d, 2, 10, 3, 11, 6, 14, 7, 15);
  to.x = __builtin_shufflevector(xy_ab, xy_cd, 0, 1, 8, 9, 4, 5, 12, 13);
  to.y = __builtin_shufflevector(xy_ab, xy_cd, 2, 3, 10, 11, 6, 7, 14, 15);
  to.turn = __builtin_shufflevector(turn_ab, turn_cd, 0, 1, 8, 9, 4, 5, 12, 13);
}

/// Rows of three numbers, four of them; a number behind the last is read.
EQUIDEM_ALWAYS_INLINE void gather(const double* motion, const std::int32_t* row, Motions<Doubles>& to) {
  const auto at = [&](int k) { return motion + 3 * static_cast<std::ptrdiff_t>(row[k]); };
  to.x = simd::load<Doubles>(at(0));
  to.y = simd::load<Doubles>(at(1));
  to.turn = simd::load<Doubles>(at(2));
  auto unused = simd::load<Doubles>(at(3));
  simd::transpose(to.x, to.y, to.turn, unused);
}

/// The rows of a group, or of a part of it; lanes behind its last row repeat the first.
template <int Count>
struct OwnRows {
  std::int32_t row[Count];
  EQUIDEM_ALWAYS_INLINE OwnRows(const GroupedRows::Group& group, int first_lane) {
    for (int k = 0; k < Count; ++k) {
      const std::size_t lane = static_cast<std::size_t>(first_lane + k);
      row[k] = static_cast<std::int32_t>(group.first_row + (lane < group.rows ? lane : 0));
    }
  }
};

/// f = K motion on the rows of a group, or of the half of it that begins at `first_lane`.
template <RowKind kind, class Lanes, class Number>
EQUIDEM_ALWAYS_INLINE void internal_force(const GroupedRows& rows, const GroupedRows::Group& group, int first_lane,
                                          const Number* motion, const Motions<Lanes>& own, Motions<Lanes>& force) {
  const Lanes zero{};
  Lanes fx = zero, fy = zero, moment = zero;
  Lanes kN = zero + rows.normal_spring(), kT = zero + rows.tangential_spring();
  const std::int32_t* other = group.other + first_lane;
  const float* geometry = group.geometry + first_lane;
  for (std::size_t slot = 0; slot < group.slots; ++slot, other += lanes, geometry += kind.fields() * lanes) {
    Motions<Lanes> there;
    gather(motion, other, there);
    if constexpr (kind.blocks) {
      Lanes entry[9];
      for (int k = 0; k < 9; ++k) load(geometry + k * lanes, entry[k]);
      fx += entry[0] * there.x + entry[1] * there.y + entry[2] * there.turn;
      fy += entry[3] * there.x + entry[4] * there.y + entry[5] * there.turn;
      moment += entry[6] * there.x + entry[7] * there.y + entry[8] * there.turn;
      continue;
    }
    Lanes nx, ny;
    load(geometry, nx);
    load(geometry + lanes, ny);
    if constexpr (kind.own_springs) {
      constexpr int springs = kind.fields() - (kind.bending ? 3 : 2);
      load(geometry + springs * lanes, kN);
      load(geometry + (springs + 1) * lanes, kT);
    }
    const Lanes dx = there.x - own.x, dy = there.y - own.y;
    Lanes stretch = nx * dx + ny * dy;
    Lanes slip = nx * dy - ny * dx;
    Lanes lever, offset;
    if constexpr (kind.rotation) {
      Lanes lever_there;
      load(geometry + 2 * lanes, lever);
      load(geometry + 3 * lanes, lever_there);
      slip -= lever * own.turn + lever_there * there.turn;
    }
    if constexpr (kind.offsets) {
      Lanes offset_there;
      load(geometry + 4 * lanes, offset);
      load(geometry + 5 * lanes, offset_there);
      stretch += offset * own.turn + offset_there * there.turn;
    }
    const Lanes normal = kN * stretch, tangential = kT * slip;
    fx -= nx * normal - ny * tangential;
    fy -= ny * normal + nx * tangential;
    if constexpr (kind.rotation) moment -= lever * tangential;
    if constexpr (kind.offsets) moment += offset * normal;
    if constexpr (kind.bending) {
      Lanes kM;
      load(geometry + (kind.fields() - 1) * lanes, kM);
      moment -= kM * (there.turn - own.turn);
    }
  }
  force = {fx, fy, moment};
}

EQUIDEM_ALWAYS_INLINE void multiply_by_inverse(const float* inverse, const Motions<Singles>& f, Motions<Singles>& to) {
  Singles xx, xy, yy, xt, yt, tt;
  load(inverse, xx);
  load(inverse + lanes, xy);
  load(inverse + 2 * lanes, yy);
  load(inverse + 3 * lanes, xt);
  load(inverse + 4 * lanes, yt);
  load(inverse + 5 * lanes, tt);
  to = {xx * f.x + xy * f.y + xt * f.turn, xy * f.x + yy * f.y + yt * f.turn, xt * f.x + yt * f.y + tt * f.turn};
}

EQUIDEM_ALWAYS_INLINE void store(const Motions<Singles>& from, const GroupedRows::Group& group, Quad* to) {
  const Singles zero{};
  const Singles xy_low = __builtin_shufflevector(from.x, from.y, 0, 8, 1, 9, 4, 12, 5, 13);
  const Singles xy_high = __builtin_shufflevector(from.x, from.y, 2, 10, 3, 11, 6, 14, 7, 15);
  const Singles turn_low = __builtin_shufflevector(from.turn, zero, 0, 8, 1, 9, 4, 12, 5, 13);
  const Singles turn_high = __builtin_shufflevector(from.turn, zero, 2, 10, 3, 11, 6, 14, 7, 15);
  Quad rows[lanes];
  rows[0] = __builtin_shufflevector(xy_low, turn_low, 0, 1, 8, 9);
  rows[1] = __builtin_shufflevector(xy_low, turn_low, 2, 3, 10, 11);
  rows[2] = __builtin_shufflevector(xy_high, turn_high, 0, 1, 8, 9);
  rows[3] = __builtin_shufflevector(xy_high, turn_high, 2, 3, 10, 11);
  rows[4] = __builtin_shufflevector(xy_low, turn_low, 4, 5, 12, 13);
  rows[5] = __builtin_shufflevector(xy_low, turn_low, 6, 7, 14, 15);
  rows[6] = __builtin_shufflevector(xy_high, turn_high, 4, 5, 12, 13);
  rows[7] = __builtin_shufflevector(xy_high, turn_high, 6, 7, 14, 15);
  if (group.rows == lanes) {
    std::memcpy(to + group.first_row, rows, sizeof rows);
  } else {
    std::memcpy(to + group.first_row, rows, group.rows * sizeof(Quad));
  }
}

/// Four rows of three numbers; fewer at the end of a group.
EQUIDEM_ALWAYS_INLINE void store(const Motions<Doubles>& from, std::size_t first_row, std::size_t rows, double* to) {
  for (std::size_t k = 0; k < rows; ++k) {
    double* row = to + 3 * (first_row + k);
    row[0] = from.x[k];
    row[1] = from.y[k];
    row[2] = from.turn[k];
  }
}

template <RowKind kind>
struct Loops {
  static EQUIDEM_ALWAYS_INLINE void start(const GroupedRows& rows, std::size_t first, std::size_t last, float factor,
                                          const Quad* b, Quad* x) {
    for (std::size_t g = first; g < last; ++g) {
      const GroupedRows::Group group = rows.group(g);
      const OwnRows<lanes> own(group, 0);
      Motions<Singles> force, motion;
      gather(b, own.row, force);
      multiply_by_inverse(group.inverse, force, motion);
      motion = {factor * motion.x, factor * motion.y, factor * motion.turn};
      store(motion, group, x);
    }
  }

  static EQUIDEM_ALWAYS_INLINE void advance(const GroupedRows& rows, std::size_t first, std::size_t last,
                                            const ChebyshevStep& step, const Quad* b, const Quad* x, Quad* next) {
    for (std::size_t g = first; g < last; ++g) {
      const GroupedRows::Group group = rows.group(g);
      const OwnRows<lanes> own(group, 0);
      Motions<Singles> here, given, force, change;
      gather(x, own.row, here);
      internal_force<kind>(rows, group, 0, x, here, force);
      gather(b, own.row, given);
      force = {given.x - force.x, given.y - force.y, given.turn - force.turn};
      multiply_by_inverse(group.inverse, force, change);
      Motions<Singles> result{here.x + step.add * change.x, here.y + step.add * change.y,
                              here.turn + step.add * change.turn};
      if (step.keep != 0) {
        Motions<Singles> before{};
        if (!step.from_zero) gather(next, own.row, before);
        result.x += step.keep * (here.x - before.x);
        result.y += step.keep * (here.y - before.y);
        result.turn += step.keep * (here.turn - before.turn);
      }
      store(result, group, next);
    }
  }

  static EQUIDEM_ALWAYS_INLINE void residual(const GroupedRows& rows, std::size_t first, std::size_t last,
                                             const Quad* b, const Quad* x, Quad* r) {
    for (std::size_t g = first; g < last; ++g) {
      const GroupedRows::Group group = rows.group(g);
      const OwnRows<lanes> own(group, 0);
      Motions<Singles> here, given, force;
      gather(x, own.row, here);
      internal_force<kind>(rows, group, 0, x, here, force);
      gather(b, own.row, given);
      force = {given.x - force.x, given.y - force.y, given.turn - force.turn};
      if (group.free != nullptr) {
        Singles x_free, y_free, turn_free;
        load(group.free, x_free);
        load(group.free + lanes, y_free);
        load(group.free + 2 * lanes, turn_free);
        force = {x_free * force.x, y_free * force.y, turn_free * force.turn};
      }
      store(force, group, r);
    }
  }

  static EQUIDEM_ALWAYS_INLINE double multiply(const GroupedRows& rows, std::size_t first, std::size_t last,
                                               const double* p, double* q) {
    double sum = 0;
    for (std::size_t g = first; g < last; ++g) {
      const GroupedRows::Group group = rows.group(g);
      for (int half = 0; half < lanes && static_cast<std::size_t>(half) < group.rows; half += 4) {
        const OwnRows<4> own(group, half);
        Motions<Doubles> here, force;
        gather(p, own.row, here);
        internal_force<kind>(rows, group, half, p, here, force);
        if (group.free != nullptr) {
          Doubles x_free, y_free, turn_free;
          load(group.free + half, x_free);
          load(group.free + lanes + half, y_free);
          load(group.free + 2 * lanes + half, turn_free);
          force = {x_free * force.x, y_free * force.y, turn_free * force.turn};
        }
        const std::size_t left = group.rows - static_cast<std::size_t>(half), count = left < 4 ? left : 4;
        store(force, group.first_row + static_cast<std::size_t>(half), count, q);
        const Doubles work = here.x * force.x + here.y * force.y + here.turn * force.turn;
        for (std::size_t k = 0; k < count; ++k) sum += work[k];
      }
    }
    return sum;
  }
};

constexpr RowKind kinds[] = {{.blocks = true},
                             {},
                             {.own_springs = true},
                             {.rotation = true},
                             {.rotation = true, .own_springs = true},
                             {.rotation = true, .offsets = true},
                             {.rotation = true, .offsets = true, .own_springs = true},
                             {.rotation = true, .bending = true},
                             {.rotation = true, .own_springs = true, .bending = true},
                             {.rotation = true, .offsets = true, .bending = true},
                             {.rotation = true, .offsets = true, .own_springs = true, .bending = true}};

/// The loops compiled for vectors of one width.
#define EQUIDEM_LOOPS(name, attributes)                                                                              \
  template <RowKind kind>                                                                                            \
  struct name {                                                                                                      \
    attributes static void start(const GroupedRows& rows, std::size_t first, std::size_t last, float factor,         \
                                 const Quad* b, Quad* x) {                                                           \
      Loops<kind>::start(rows, first, last, factor, b, x);                                                           \
    }                                                                                                                \
    attributes static void advance(const GroupedRows& rows, std::size_t first, std::size_t last,                     \
                                   const ChebyshevStep& step, const Quad* b, const Quad* x, Quad* next) {            \
      Loops<kind>::advance(rows, first, last, step, b, x, next);                                                     \
    }                                                                                                                \
    attributes static void residual(const GroupedRows& rows, std::size_t first, std::size_t last, const Quad* b,     \
                                    const Quad* x, Quad* r) {                                                        \
      Loops<kind>::residual(rows, first, last, b, x, r);                                                             \
    }                                                                                                                \
    attributes static double multiply(const GroupedRows& rows, std::size_t first, std::size_t last, const double* p, \
                                      double* q) {                                                                   \
      return Loops<kind>::multiply(rows, first, last, p, q);                                                         \
    }                                                                                                                \
  }

EQUIDEM_LOOPS(PlainLoops, );
#if defined(__x86_64__)
EQUIDEM_LOOPS(WideLoops, __attribute__((target("avx2,fma"))));
#endif

template <template <RowKind> class Compiled, std::size_t... Index>
constexpr std::array<RowFunctions, sizeof...(Index)> functions(std::index_sequence<Index...>) {
  return {RowFunctions{&Compiled<kinds[Index]>::start, &Compiled<kinds[Index]>::advance,
                       &Compiled<kinds[Index]>::residual, &Compiled<kinds[Index]>::multiply}...};
}

}  // namespace

const RowFunctions& row_functions(const RowKind& kind) {
  constexpr auto all = std::make_index_sequence<std::size(kinds)>{};
  std::size_t index = 0;
  while (!(kinds[index] == kind)) ++index;
#if defined(__x86_64__)
  static constexpr auto wide = functions<WideLoops>(all);
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return wide[index];
#endif
  static constexpr auto plain = functions<PlainLoops>(all);
  return plain[index];
}

}  // namespace equidem::multigrid
