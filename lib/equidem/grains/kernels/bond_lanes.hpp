// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Pieces of the loops over bonds.
#pragma once

#include <algorithm>
#include <iterator>
#include <limits>
#include <numbers>

#include "equidem/core/simd.hpp"
#include "equidem/grains/grain_system.hpp"

namespace equidem::eight {

/// The angle of (x, y), x > 0 in most lanes. By a short polynomial within 1/64 of the direction of x; a lane takes the
/// longer one by its own numbers alone.
template <class Lanes>
EQUIDEM_ALWAYS_INLINE Lanes turn_of(const Lanes& x, const Lanes& y) {
  constexpr double near = 1.0 / 64;
  const Lanes t = y / x, z = t * t;
  const Lanes turn = small_arctangent(t, z);
  const Bits<Lanes> far = negative(near * near - z) | negative(x);
  if (!any(far)) return turn;
  return choose(far, angle_of(x, y), turn);
}

EQUIDEM_ALWAYS_INLINE Four two_and_two(const void* first, const void* second, const Four&) {
  return __builtin_shufflevector(load<Two>(first), load<Two>(second), 0, 1, 2, 3);
}
EQUIDEM_ALWAYS_INLINE Twice<Two> two_and_two(const void* first, const void* second, const Twice<Two>&) {
  return {load<Two>(first), load<Two>(second)};
}
/// (x, y, t, t) of a row (x, y, t, u).
EQUIDEM_ALWAYS_INLINE Four third_twice(const Four& row) {
  return __builtin_shufflevector(row, row, 0, 1, 2, 2);
}
EQUIDEM_ALWAYS_INLINE Twice<Two> third_twice(const Twice<Two>& row) {
  return {row.low, __builtin_shufflevector(row.high, row.high, 0, 0)};
}
/// (x, y, u, u) of a row (x, y, t, u).
EQUIDEM_ALWAYS_INLINE Four fourth_twice(const Four& row) {
  return __builtin_shufflevector(row, row, 0, 1, 3, 3);
}
EQUIDEM_ALWAYS_INLINE Twice<Two> fourth_twice(const Twice<Two>& row) {
  return {row.low, __builtin_shufflevector(row.high, row.high, 1, 1)};
}

/// Velocity, speed of the rim and spin of both bodies of a bond, or what these gain, as rates: differences of
/// velocities and spins, sum of the speeds of the rims.
template <class Numbers>
EQUIDEM_ALWAYS_INLINE Numbers between(const Numbers& of_i, const Numbers& of_j) {
  constexpr long long minus = std::numeric_limits<long long>::min();
  alignas(32) constexpr long long difference[4] = {minus, minus, 0, minus};
  return of_j + as<Numbers>(bits_of(of_i) ^ load<Bits<Numbers>>(difference));
}

/// (x, y, t, 0) of a row (x, y, t, u).
template <class Numbers>
EQUIDEM_ALWAYS_INLINE Numbers without_fourth(const Numbers& row) {
  alignas(32) constexpr long long three[4] = {-1, -1, -1, 0};
  return as<Numbers>(bits_of(row) & load<Bits<Numbers>>(three));
}

/// Ways from the second bodies to their images.
template <class Lanes>
EQUIDEM_ALWAYS_INLINE Vectors<Lanes> shift_of(const Periods& periods, const BondImages& images) {
  const auto a = load<Lanes>(images.a), b = load<Lanes>(images.b);
  return {a * periods.a.x + b * periods.b.x, a * periods.a.y + b * periods.b.y};
}

/// Sum over bonds of their impulses on images times the ways to these (CellSums).
template <class Lanes>
struct ImageSums {
  Lanes xx{}, xy{}, yx{}, yy{};

  EQUIDEM_ALWAYS_INLINE void add(const Lanes& x, const Lanes& y, const Vectors<Lanes>& shift) {
    xx += x * shift.x;
    xy += x * shift.y;
    yx += y * shift.x;
    yy += y * shift.y;
  }
  [[nodiscard]] EQUIDEM_ALWAYS_INLINE Tensor2 sum() const { return {add_up(xx), add_up(xy), add_up(yx), add_up(yy)}; }
};

/// Bonds as they lie and move.
template <class Lanes>
struct BondNow {
  Lanes x, y, u, v;                        ///< branch and its rate
  Lanes spin_i, angle_i, spin_j, angle_j;  ///< where bodies turn
};

/// \tparam turns whether bodies turn \tparam cell whether bonds are with images
template <class Lanes, bool turns, bool cell>
EQUIDEM_ALWAYS_INLINE BondNow<Lanes> bonds_now(const GrainSystem& system, std::size_t g) {
  const BondGroup& group = system.bonds.packed.groups[g];
  const GrainMotion* motions = system.bodies.motions.data();
  Row<Lanes> apart[lanes_of_pairs], angles[lanes_of_pairs];
  for (std::size_t k = 0; k < lanes_of_pairs; ++k) {
    const GrainMotion &i = motions[group.i[k]], &j = motions[group.j[k]];
    apart[k] = load<Row<Lanes>>(&j) - load<Row<Lanes>>(&i);  // position and velocity
    if constexpr (turns) angles[k] = two_and_two(&i.spin, &j.spin, Row<Lanes>{});
  }
  BondNow<Lanes> now{};
  columns_of(apart, now.x, now.y, now.u, now.v);
  if constexpr (turns) columns_of(angles, now.spin_i, now.angle_i, now.spin_j, now.angle_j);
  if constexpr (cell) {
    const Vectors<Lanes> shift = shift_of<Lanes>(system.cell.now, system.bonds.packed.images[g]);
    now.x += shift.x;
    now.y += shift.y;
  }
  return now;
}

/// Set BondBatch::nearest.
template <class Lanes>
EQUIDEM_ALWAYS_INLINE void take_nearest(const Lanes& nearest, BondBatch& batch) {
  PairLanes least;
  store(nearest, least);
  batch.nearest = *std::min_element(std::begin(least), std::end(least));
}

}  // namespace equidem::eight
