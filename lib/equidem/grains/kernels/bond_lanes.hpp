// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Pieces of the loops over bonds.
#pragma once

#include <limits>
#include <numbers>

#include "equidem/dynamics/kernels/lanes_math.hpp"
#include "equidem/grains/grain_system.hpp"
#include "equidem/grains/kernels/pair_lanes.hpp"

namespace equidem::eight {

/// lanes::angle_of for all numbers of eight bonds.
template <class Lanes>
EQUIDEM_ALWAYS_INLINE Lanes direction_of(const Lanes& x, const Lanes& y) {
  using std::numbers::pi;
  constexpr double smallest = 1e-300;
  const Lanes across = magnitude(x), up = magnitude(y);
  const Bits<Lanes> steep = negative(across - up);
  const Lanes larger = choose(steep, up, across), smaller = choose(steep, across, up);
  const Bits<Lanes> turned = negative(lanes::tan_pi_8 * larger - smaller);
  const Lanes t = choose(turned, smaller - larger, smaller) / (choose(turned, smaller + larger, larger) + smallest);
  const Lanes z = t * t;
  Lanes angle = t + (t * z * lanes::arctangent_series(z) + only(turned, all<Lanes>(lanes::rest_of_pi_4)));
  angle = choose(turned, pi / 4 + angle, angle);
  angle = choose(steep, pi / 2 - angle, angle);
  angle = choose(negative(x), pi - angle, angle);
  return as<Lanes>(bits_of(angle) ^ (bits_of(y) & std::numeric_limits<long long>::min()));
}

/// The angle of (x, y), x > 0 in most lanes. By a short polynomial within 1/64 of the direction of x; a lane takes the
/// longer one by its own numbers alone.
template <class Lanes>
EQUIDEM_ALWAYS_INLINE Lanes turn_of(const Lanes& x, const Lanes& y) {
  constexpr double near = 1.0 / 64;
  const Lanes t = y / x, z = t * t;
  const Lanes turn = lanes::small_arctangent(t, z);
  const Bits<Lanes> far = negative(near * near - z) | negative(x);
  if (!any(far)) return turn;
  return choose(far, direction_of(x, y), turn);
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

/// Gains of both bodies of a bond, of which rows are velocity, speed of the rim, spin, as rates: differences of
/// velocities and spins, sum of the speeds of the rims.
template <class Numbers>
EQUIDEM_ALWAYS_INLINE Numbers between(const Numbers& of_i, const Numbers& of_j) {
  constexpr long long minus = std::numeric_limits<long long>::min();
  alignas(32) constexpr long long difference[4] = {minus, minus, 0, minus};
  return of_j + as<Numbers>(bits_of(of_i) ^ load<Bits<Numbers>>(difference));
}

/// Rates or gains of eight bonds.
template <class Lanes>
struct BondLanes {
  Lanes normal, tangential, rolling;
};

template <class Lanes>
EQUIDEM_ALWAYS_INLINE BondLanes<Lanes> rates_of(const BondRates& frame, const Row<Lanes> (&rows)[lanes_of_pairs]) {
  Lanes x, y, rims, spin;
  columns_of(rows, x, y, rims, spin);
  const auto nx = load<Lanes>(frame.nx), ny = load<Lanes>(frame.ny);
  return {x * nx + y * ny, y * nx - x * ny - load<Lanes>(frame.share) * rims, spin};
}

}  // namespace equidem::eight
