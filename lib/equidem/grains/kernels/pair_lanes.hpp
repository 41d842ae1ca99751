// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Eight numbers, one for each pair of a group, in vectors as wide as those of the processor: an Eight, or fewer
/// numbers Twice. Plain C++ with the vector types of GCC and Clang.
#pragma once

#include <cstddef>
#include <cstring>
#include <limits>
#include <type_traits>
#include <utility>

#include "equidem/core/square_root.hpp"
#include "equidem/grains/kernels/vector_width.hpp"

namespace equidem::eight {

template <class Lanes>
constexpr bool in_halves = requires(Lanes lanes) {
  lanes.low;
};

/// Numbers and bits lane by lane; either side may be one number for all lanes, as with the vectors of the compiler.
#define EQUIDEM_LANE_BY_LANE(op)                                                                                 \
  template <class A, class B>                                                                                    \
  EQUIDEM_ALWAYS_INLINE auto operator op(const Twice<A>& a, const Twice<B>& b) {                                 \
    return Twice<decltype(a.low op b.low)>{a.low op b.low, a.high op b.high};                                    \
  }                                                                                                              \
  template <class Half, class Number>                                                                            \
  requires std::is_arithmetic_v<Number> EQUIDEM_ALWAYS_INLINE auto operator op(const Twice<Half>& a, Number b) { \
    return Twice<decltype(a.low op b)>{a.low op b, a.high op b};                                                 \
  }                                                                                                              \
  template <class Half, class Number>                                                                            \
  requires std::is_arithmetic_v<Number> EQUIDEM_ALWAYS_INLINE auto operator op(Number a, const Twice<Half>& b) { \
    return Twice<decltype(a op b.low)>{a op b.low, a op b.high};                                                 \
  }
EQUIDEM_LANE_BY_LANE(+)
EQUIDEM_LANE_BY_LANE(-)
EQUIDEM_LANE_BY_LANE(*)
EQUIDEM_LANE_BY_LANE(/)
EQUIDEM_LANE_BY_LANE(&)
EQUIDEM_LANE_BY_LANE(|)
EQUIDEM_LANE_BY_LANE(^)
EQUIDEM_LANE_BY_LANE(>>)
EQUIDEM_LANE_BY_LANE(<)
EQUIDEM_LANE_BY_LANE(>)
#undef EQUIDEM_LANE_BY_LANE
template <class Half>
EQUIDEM_ALWAYS_INLINE Twice<Half> operator-(const Twice<Half>& a) {
  return {-a.low, -a.high};
}
template <class Half>
EQUIDEM_ALWAYS_INLINE Twice<Half> operator~(const Twice<Half>& a) {
  return {~a.low, ~a.high};
}
template <class Half, class Other>
EQUIDEM_ALWAYS_INLINE void operator+=(Twice<Half>& a, const Other& b) {
  a = a + b;
}
template <class Half, class Other>
EQUIDEM_ALWAYS_INLINE void operator-=(Twice<Half>& a, const Other& b) {
  a = a - b;
}
template <class Half, class Other>
EQUIDEM_ALWAYS_INLINE void operator*=(Twice<Half>& a, const Other& b) {
  a = a * b;
}
template <class Half, class Other>
EQUIDEM_ALWAYS_INLINE void operator|=(Twice<Half>& a, const Other& b) {
  a = a | b;
}

/// Eight whole numbers; as a choice, all bits of a lane are set or none is.
template <class Lanes>
using Bits = decltype(std::declval<Lanes>() < std::declval<Lanes>());

/// Reads the same bits as numbers, or as whole numbers.
template <class To, class From>
EQUIDEM_ALWAYS_INLINE To as(const From& lanes) {
  if constexpr (in_halves<From>) {
    return {as<decltype(To::low)>(lanes.low), as<decltype(To::low)>(lanes.high)};
  } else {
    return reinterpret_cast<To>(lanes);
  }
}
template <class Lanes>
EQUIDEM_ALWAYS_INLINE Bits<Lanes> bits_of(const Lanes& lanes) {
  return as<Bits<Lanes>>(lanes);
}

/// Half by half: a struct that is copied as a whole does not stay in registers.
template <class Lanes>
EQUIDEM_ALWAYS_INLINE Lanes load(const void* from) {
  if constexpr (in_halves<Lanes>) {
    using Half = decltype(Lanes::low);
    return {load<Half>(from), load<Half>(static_cast<const char*>(from) + sizeof(Half))};
  } else {
    Lanes lanes;
    std::memcpy(&lanes, from, sizeof lanes);
    return lanes;
  }
}
template <class Lanes>
EQUIDEM_ALWAYS_INLINE void store(const Lanes& lanes, void* to) {
  if constexpr (in_halves<Lanes>) {
    store(lanes.low, to);
    store(lanes.high, static_cast<char*>(to) + sizeof lanes.low);
  } else {
    std::memcpy(to, &lanes, sizeof lanes);
  }
}
template <class Lanes, class Number>
EQUIDEM_ALWAYS_INLINE Lanes all(Number value) {
  return Lanes{} + value;
}

template <class Lanes>
EQUIDEM_ALWAYS_INLINE Lanes larger(const Lanes& a, const Lanes& b) {
  if constexpr (in_halves<Lanes>) {
    return {larger(a.low, b.low), larger(a.high, b.high)};
  } else {
    return a > b ? a : b;
  }
}
template <class Lanes>
EQUIDEM_ALWAYS_INLINE Lanes smaller(const Lanes& a, const Lanes& b) {
  if constexpr (in_halves<Lanes>) {
    return {smaller(a.low, b.low), smaller(a.high, b.high)};
  } else {
    return a < b ? a : b;
  }
}
/// x, or what is nearest to it of [-most, most].
template <class Lanes>
EQUIDEM_ALWAYS_INLINE Lanes within(const Lanes& x, const Lanes& most) {
  return smaller(larger(x, -most), most);
}
using equidem::square_root;
template <class Half>
EQUIDEM_ALWAYS_INLINE Twice<Half> square_root(const Twice<Half>& x) {
  return {square_root(x.low), square_root(x.high)};
}
template <class Lanes>
EQUIDEM_ALWAYS_INLINE Lanes magnitude(const Lanes& x) {
  return as<Lanes>(bits_of(x) & std::numeric_limits<long long>::max());
}
/// |size| with the sign of `sign`.
template <class Lanes>
EQUIDEM_ALWAYS_INLINE Lanes with_sign(const Lanes& size, const Lanes& sign) {
  return as<Lanes>(bits_of(size) | (bits_of(sign) & std::numeric_limits<long long>::min()));
}
/// The lanes below zero (-0 included). Choices from sign bits are combined in vector registers; some compilers move
/// results of comparisons through scalars.
template <class Lanes>
EQUIDEM_ALWAYS_INLINE Bits<Lanes> negative(const Lanes& x) {
  return bits_of(x) >> 63;
}
template <class Lanes>
EQUIDEM_ALWAYS_INLINE Lanes choose(const Bits<Lanes>& choice, const Lanes& a, const Lanes& b) {
  return as<Lanes>((choice & bits_of(a)) | (~choice & bits_of(b)));
}
/// Square of the branch (x, y). Centres that coincide get a branch so short that nothing but their normal comes from
/// it: (1, 0). A number added to x without a choice would make the normals of branches along y turn.
template <class Lanes>
EQUIDEM_ALWAYS_INLINE Lanes square_of_branch(Lanes& x, const Lanes& y) {
  constexpr double shortest = 1e-150;
  const Lanes square = x * x + y * y;
  const Bits<Lanes> distinct = negative(Lanes{} - square);
  x = choose(distinct, x, all<Lanes>(shortest));
  return choose(distinct, square, all<Lanes>(shortest * shortest));
}
/// a where chosen, zero elsewhere.
template <class Lanes>
EQUIDEM_ALWAYS_INLINE Lanes only(const Bits<Lanes>& choice, const Lanes& a) {
  return as<Lanes>(choice & bits_of(a));
}
/// Bitwise or of all lanes.
template <class Lanes>
EQUIDEM_ALWAYS_INLINE long long bits_of_all(const Lanes& bits) {
  if constexpr (in_halves<Lanes>) {
    return bits_of_all(bits.low | bits.high);
  } else if constexpr (sizeof(Lanes) == sizeof(Eight)) {
    return bits_of_all(__builtin_shufflevector(bits, bits, 0, 1, 2, 3) |
                       __builtin_shufflevector(bits, bits, 4, 5, 6, 7));
  } else if constexpr (sizeof(Lanes) == sizeof(Four)) {
    return (bits[0] | bits[1]) | (bits[2] | bits[3]);
  } else {
    return bits[0] | bits[1];
  }
}
template <class Lanes>
EQUIDEM_ALWAYS_INLINE bool any(const Lanes& choice) {
  return bits_of_all(choice) != 0;
}

/// start + the lanes, one after the other.
template <class Lanes>
EQUIDEM_ALWAYS_INLINE double add_up(const Lanes& lanes, double start = 0) {
  double each[sizeof(Lanes) / sizeof(double)];
  store(lanes, each);
  for (const double one : each) start += one;
  return start;
}

EQUIDEM_ALWAYS_INLINE Eight even_of(const Eight& a, const Eight& b) {
  return __builtin_shufflevector(a, b, 0, 8, 2, 10, 4, 12, 6, 14);
}
EQUIDEM_ALWAYS_INLINE Eight odd_of(const Eight& a, const Eight& b) {
  return __builtin_shufflevector(a, b, 1, 9, 3, 11, 5, 13, 7, 15);
}
/// The first and third pairs of lanes of a, then of b.
EQUIDEM_ALWAYS_INLINE Eight even_twos_of(const Eight& a, const Eight& b) {
  return __builtin_shufflevector(a, b, 0, 1, 4, 5, 8, 9, 12, 13);
}
EQUIDEM_ALWAYS_INLINE Eight odd_twos_of(const Eight& a, const Eight& b) {
  return __builtin_shufflevector(a, b, 2, 3, 6, 7, 10, 11, 14, 15);
}

/// Rows turned into columns, as many as each has numbers.
EQUIDEM_ALWAYS_INLINE void transpose(Two (&m)[2]) {
  const Two a = m[0], b = m[1];
  m[0] = __builtin_shufflevector(a, b, 0, 2);
  m[1] = __builtin_shufflevector(a, b, 1, 3);
}
EQUIDEM_ALWAYS_INLINE void transpose(Four (&m)[4]) {
  const Four e01 = __builtin_shufflevector(m[0], m[1], 0, 4, 2, 6);
  const Four o01 = __builtin_shufflevector(m[0], m[1], 1, 5, 3, 7);
  const Four e23 = __builtin_shufflevector(m[2], m[3], 0, 4, 2, 6);
  const Four o23 = __builtin_shufflevector(m[2], m[3], 1, 5, 3, 7);
  m[0] = __builtin_shufflevector(e01, e23, 0, 1, 4, 5);
  m[1] = __builtin_shufflevector(o01, o23, 0, 1, 4, 5);
  m[2] = __builtin_shufflevector(e01, e23, 2, 3, 6, 7);
  m[3] = __builtin_shufflevector(o01, o23, 2, 3, 6, 7);
}
EQUIDEM_ALWAYS_INLINE void transpose(Eight (&m)[8]) {
  const Eight e01 = even_of(m[0], m[1]), o01 = odd_of(m[0], m[1]), e23 = even_of(m[2], m[3]), o23 = odd_of(m[2], m[3]);
  const Eight e45 = even_of(m[4], m[5]), o45 = odd_of(m[4], m[5]), e67 = even_of(m[6], m[7]), o67 = odd_of(m[6], m[7]);
  const Eight c04_low = even_twos_of(e01, e23), c04_high = even_twos_of(e45, e67);
  const Eight c26_low = odd_twos_of(e01, e23), c26_high = odd_twos_of(e45, e67);
  const Eight c15_low = even_twos_of(o01, o23), c15_high = even_twos_of(o45, o67);
  const Eight c37_low = odd_twos_of(o01, o23), c37_high = odd_twos_of(o45, o67);
  m[0] = even_twos_of(c04_low, c04_high);
  m[4] = odd_twos_of(c04_low, c04_high);
  m[2] = even_twos_of(c26_low, c26_high);
  m[6] = odd_twos_of(c26_low, c26_high);
  m[1] = even_twos_of(c15_low, c15_high);
  m[5] = odd_twos_of(c15_low, c15_high);
  m[3] = even_twos_of(c37_low, c37_high);
  m[7] = odd_twos_of(c37_low, c37_high);
}
template <class Half, std::size_t n>
EQUIDEM_ALWAYS_INLINE void transpose(Twice<Half> (&m)[n]) {
  constexpr std::size_t half = n / 2;
  Half low_low[half], low_high[half], high_low[half], high_high[half];
  for (std::size_t k = 0; k < half; ++k) {
    low_low[k] = m[k].low;
    low_high[k] = m[k].high;
    high_low[k] = m[half + k].low;
    high_high[k] = m[half + k].high;
  }
  transpose(low_low);
  transpose(low_high);
  transpose(high_low);
  transpose(high_high);
  for (std::size_t k = 0; k < half; ++k) {
    m[k] = {low_low[k], high_low[k]};
    m[half + k] = {low_high[k], high_high[k]};
  }
}

/// Four numbers of one pair.
template <class Lanes>
using Row = std::conditional_t<std::is_same_v<Lanes, Twice<Twice<Two>>>, Twice<Two>, Four>;

/// Four columns turned into eight rows of four.
EQUIDEM_ALWAYS_INLINE void rows_of(const Eight& a, const Eight& b, const Eight& c, const Eight& d, Four (&row)[8]) {
  const Eight ab_even = even_of(a, b), ab_odd = odd_of(a, b), cd_even = even_of(c, d), cd_odd = odd_of(c, d);
  const Eight r02 = __builtin_shufflevector(ab_even, cd_even, 0, 1, 8, 9, 2, 3, 10, 11);
  const Eight r46 = __builtin_shufflevector(ab_even, cd_even, 4, 5, 12, 13, 6, 7, 14, 15);
  const Eight r13 = __builtin_shufflevector(ab_odd, cd_odd, 0, 1, 8, 9, 2, 3, 10, 11);
  const Eight r57 = __builtin_shufflevector(ab_odd, cd_odd, 4, 5, 12, 13, 6, 7, 14, 15);
  row[0] = __builtin_shufflevector(r02, r02, 0, 1, 2, 3);
  row[2] = __builtin_shufflevector(r02, r02, 4, 5, 6, 7);
  row[4] = __builtin_shufflevector(r46, r46, 0, 1, 2, 3);
  row[6] = __builtin_shufflevector(r46, r46, 4, 5, 6, 7);
  row[1] = __builtin_shufflevector(r13, r13, 0, 1, 2, 3);
  row[3] = __builtin_shufflevector(r13, r13, 4, 5, 6, 7);
  row[5] = __builtin_shufflevector(r57, r57, 0, 1, 2, 3);
  row[7] = __builtin_shufflevector(r57, r57, 4, 5, 6, 7);
}
template <class Half>
EQUIDEM_ALWAYS_INLINE void rows_of(const Twice<Half>& a, const Twice<Half>& b, const Twice<Half>& c,
                                   const Twice<Half>& d, Half (&row)[8]) {
  Half low[4] = {a.low, b.low, c.low, d.low}, high[4] = {a.high, b.high, c.high, d.high};
  transpose(low);
  transpose(high);
  for (int k = 0; k < 4; ++k) {
    row[k] = low[k];
    row[4 + k] = high[k];
  }
}

/// Eight rows of four turned into four columns.
EQUIDEM_ALWAYS_INLINE void columns_of(const Four (&row)[8], Eight& a, Eight& b, Eight& c, Eight& d) {
  Eight twos[4];
  for (int k = 0; k < 4; ++k) twos[k] = __builtin_shufflevector(row[k], row[k + 4], 0, 1, 2, 3, 4, 5, 6, 7);
  const Eight even_low = even_of(twos[0], twos[1]), even_high = even_of(twos[2], twos[3]);
  const Eight odd_low = odd_of(twos[0], twos[1]), odd_high = odd_of(twos[2], twos[3]);
  a = __builtin_shufflevector(even_low, even_high, 0, 1, 8, 9, 4, 5, 12, 13);
  b = __builtin_shufflevector(odd_low, odd_high, 0, 1, 8, 9, 4, 5, 12, 13);
  c = __builtin_shufflevector(even_low, even_high, 2, 3, 10, 11, 6, 7, 14, 15);
  d = __builtin_shufflevector(odd_low, odd_high, 2, 3, 10, 11, 6, 7, 14, 15);
}
template <class Half>
EQUIDEM_ALWAYS_INLINE void columns_of(const Half (&row)[8], Twice<Half>& a, Twice<Half>& b, Twice<Half>& c,
                                      Twice<Half>& d) {
  Half low[4] = {row[0], row[1], row[2], row[3]}, high[4] = {row[4], row[5], row[6], row[7]};
  transpose(low);
  transpose(high);
  a = {low[0], high[0]};
  b = {low[1], high[1]};
  c = {low[2], high[2]};
  d = {low[3], high[3]};
}

/// to += change, for the rows of a body.
template <class Numbers>
EQUIDEM_ALWAYS_INLINE void add(void* to, const Numbers& change) {
  store(load<Numbers>(to) + change, to);
}
template <class Numbers>
EQUIDEM_ALWAYS_INLINE void subtract(void* from, const Numbers& change) {
  store(load<Numbers>(from) - change, from);
}

/// Eight vectors.
template <class Lanes>
struct Vectors {
  Lanes x, y;
};

}  // namespace equidem::eight
