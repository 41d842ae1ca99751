// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Vectors of eight numbers, one for each pair of a group. Plain C++ with the vector types of GCC and Clang.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

#include "equidem/core/square_root.hpp"
#include "equidem/grains/kernels/vector_width.hpp"

namespace equidem::eight {

using Lanes = double __attribute__((vector_size(64)));
using Choice = long long __attribute__((vector_size(64)));
using Half = double __attribute__((vector_size(32)));
using HalfChoice = long long __attribute__((vector_size(32)));
using Pair = double __attribute__((vector_size(16)));

EQUIDEM_ALWAYS_INLINE Lanes load(const double* from) {
  Lanes lanes;
  std::memcpy(&lanes, from, sizeof lanes);
  return lanes;
}
EQUIDEM_ALWAYS_INLINE void store(const Lanes& lanes, double* to) {
  std::memcpy(to, &lanes, sizeof lanes);
}
EQUIDEM_ALWAYS_INLINE Lanes all(double value) {
  return Lanes{value, value, value, value, value, value, value, value};
}
EQUIDEM_ALWAYS_INLINE Lanes larger(const Lanes& a, const Lanes& b) {
  return a > b ? a : b;
}
EQUIDEM_ALWAYS_INLINE Lanes smaller(const Lanes& a, const Lanes& b) {
  return a < b ? a : b;
}
EQUIDEM_ALWAYS_INLINE Lanes magnitude(const Lanes& x) {
  return reinterpret_cast<Lanes>(reinterpret_cast<Choice>(x) & std::numeric_limits<long long>::max());
}
/// |size| with the sign of `sign`.
EQUIDEM_ALWAYS_INLINE Lanes with_sign(const Lanes& size, const Lanes& sign) {
  return reinterpret_cast<Lanes>(reinterpret_cast<Choice>(size) |
                                 (reinterpret_cast<Choice>(sign) & std::numeric_limits<long long>::min()));
}
/// Mask of the lanes below zero (-0 included). Masks from sign bits are combined in vector registers; some compilers
/// move results of comparisons through scalars.
EQUIDEM_ALWAYS_INLINE Choice negative(const Choice& x) {
  return x >> 63;
}
EQUIDEM_ALWAYS_INLINE Choice negative(const Lanes& x) {
  return negative(reinterpret_cast<Choice>(x));
}
EQUIDEM_ALWAYS_INLINE Choice choose(const Choice& bits, const Choice& a, const Choice& b) {
  return (bits & a) | (~bits & b);
}
EQUIDEM_ALWAYS_INLINE Lanes choose(const Choice& bits, const Lanes& a, const Lanes& b) {
  return reinterpret_cast<Lanes>(choose(bits, reinterpret_cast<Choice>(a), reinterpret_cast<Choice>(b)));
}
/// a where the mask is set, zero elsewhere.
EQUIDEM_ALWAYS_INLINE Lanes only(const Choice& bits, const Lanes& a) {
  return reinterpret_cast<Lanes>(bits & reinterpret_cast<Choice>(a));
}
/// Bitwise or of all lanes.
EQUIDEM_ALWAYS_INLINE long long bits_of_all(const Choice& choice) {
  const HalfChoice half =
      __builtin_shufflevector(choice, choice, 0, 1, 2, 3) | __builtin_shufflevector(choice, choice, 4, 5, 6, 7);
  return (half[0] | half[1]) | (half[2] | half[3]);
}
EQUIDEM_ALWAYS_INLINE bool any(const Choice& choice) {
  return bits_of_all(choice) != 0;
}

EQUIDEM_ALWAYS_INLINE Lanes even_of(const Lanes& a, const Lanes& b) {
  return __builtin_shufflevector(a, b, 0, 8, 2, 10, 4, 12, 6, 14);
}
EQUIDEM_ALWAYS_INLINE Lanes odd_of(const Lanes& a, const Lanes& b) {
  return __builtin_shufflevector(a, b, 1, 9, 3, 11, 5, 13, 7, 15);
}
/// The first and third pairs of lanes of a, then of b.
EQUIDEM_ALWAYS_INLINE Lanes even_twos_of(const Lanes& a, const Lanes& b) {
  return __builtin_shufflevector(a, b, 0, 1, 4, 5, 8, 9, 12, 13);
}
EQUIDEM_ALWAYS_INLINE Lanes odd_twos_of(const Lanes& a, const Lanes& b) {
  return __builtin_shufflevector(a, b, 2, 3, 6, 7, 10, 11, 14, 15);
}

/// Eight rows of eight numbers turned into eight columns.
EQUIDEM_ALWAYS_INLINE void transpose(Lanes (&m)[8]) {
  const Lanes e01 = even_of(m[0], m[1]), o01 = odd_of(m[0], m[1]), e23 = even_of(m[2], m[3]), o23 = odd_of(m[2], m[3]);
  const Lanes e45 = even_of(m[4], m[5]), o45 = odd_of(m[4], m[5]), e67 = even_of(m[6], m[7]), o67 = odd_of(m[6], m[7]);
  const Lanes c04_low = even_twos_of(e01, e23), c04_high = even_twos_of(e45, e67);
  const Lanes c26_low = odd_twos_of(e01, e23), c26_high = odd_twos_of(e45, e67);
  const Lanes c15_low = even_twos_of(o01, o23), c15_high = even_twos_of(o45, o67);
  const Lanes c37_low = odd_twos_of(o01, o23), c37_high = odd_twos_of(o45, o67);
  m[0] = even_twos_of(c04_low, c04_high);
  m[4] = odd_twos_of(c04_low, c04_high);
  m[2] = even_twos_of(c26_low, c26_high);
  m[6] = odd_twos_of(c26_low, c26_high);
  m[1] = even_twos_of(c15_low, c15_high);
  m[5] = odd_twos_of(c15_low, c15_high);
  m[3] = even_twos_of(c37_low, c37_high);
  m[7] = odd_twos_of(c37_low, c37_high);
}

/// Four columns turned into eight rows of four.
EQUIDEM_ALWAYS_INLINE void rows_of(const Lanes& a, const Lanes& b, const Lanes& c, const Lanes& d, Half (&row)[8]) {
  const Lanes ab_even = even_of(a, b), ab_odd = odd_of(a, b), cd_even = even_of(c, d), cd_odd = odd_of(c, d);
  const Lanes r02 = __builtin_shufflevector(ab_even, cd_even, 0, 1, 8, 9, 2, 3, 10, 11);
  const Lanes r46 = __builtin_shufflevector(ab_even, cd_even, 4, 5, 12, 13, 6, 7, 14, 15);
  const Lanes r13 = __builtin_shufflevector(ab_odd, cd_odd, 0, 1, 8, 9, 2, 3, 10, 11);
  const Lanes r57 = __builtin_shufflevector(ab_odd, cd_odd, 4, 5, 12, 13, 6, 7, 14, 15);
  row[0] = __builtin_shufflevector(r02, r02, 0, 1, 2, 3);
  row[2] = __builtin_shufflevector(r02, r02, 4, 5, 6, 7);
  row[4] = __builtin_shufflevector(r46, r46, 0, 1, 2, 3);
  row[6] = __builtin_shufflevector(r46, r46, 4, 5, 6, 7);
  row[1] = __builtin_shufflevector(r13, r13, 0, 1, 2, 3);
  row[3] = __builtin_shufflevector(r13, r13, 4, 5, 6, 7);
  row[5] = __builtin_shufflevector(r57, r57, 0, 1, 2, 3);
  row[7] = __builtin_shufflevector(r57, r57, 4, 5, 6, 7);
}

EQUIDEM_ALWAYS_INLINE void put(const Half& row, void* to) {
  std::memcpy(to, &row, sizeof row);
}
/// to += change, for the rows of a body.
EQUIDEM_ALWAYS_INLINE void add(void* to, const Half& change) {
  Half sum;
  std::memcpy(&sum, to, sizeof sum);
  sum += change;
  std::memcpy(to, &sum, sizeof sum);
}
EQUIDEM_ALWAYS_INLINE void subtract(void* from, const Half& change) {
  Half rest;
  std::memcpy(&rest, from, sizeof rest);
  rest -= change;
  std::memcpy(from, &rest, sizeof rest);
}

}  // namespace equidem::eight
