// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Vectors of numbers in plain C++ with the vector types of GCC and Clang, for loops over any number of lanes: those of
/// one vector of the processor, or Twice as many. The compiler selects the instructions.
/// Roots and angles of all lanes at once: no branches, no tables, bit-identical on every machine.
#pragma once

#include <cstddef>
#include <cstring>
#include <limits>
#include <numbers>
#include <type_traits>
#include <utility>

#include "equidem/core/square_root.hpp"

/// Attribute of functions that are part of every function that calls them.
#define EQUIDEM_ALWAYS_INLINE inline __attribute__((always_inline))
/// Attributes of functions compiled for vectors of 256 and of 512 bits, without fused multiply-add: results are
/// bit-identical on every machine.
#define EQUIDEM_BY_FOURS __attribute__((target("avx2")))
#if defined(__clang__)
#define EQUIDEM_BY_EIGHTS __attribute__((target("avx2,avx512f,avx512vl,avx512dq")))
#else
#define EQUIDEM_BY_EIGHTS __attribute__((target("avx2,avx512f,avx512vl,avx512dq,prefer-vector-width=512")))
#endif

namespace equidem::simd {

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wpsabi"  // vectors are passed between inlined functions only

// Numbers in one vector of the processor.
using One = double __attribute__((vector_size(8)));
using Two = double __attribute__((vector_size(16)));
using Four = double __attribute__((vector_size(32)));
using Eight = double __attribute__((vector_size(64)));

/// Twice as many numbers: compilers make slow code of vectors wider than those of the processor.
template <class Half>
struct Twice {
  Half low, high;
};

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
  } else if constexpr (sizeof(Lanes) == sizeof(Two)) {
    return bits[0] | bits[1];
  } else {
    return bits[0];
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
EQUIDEM_ALWAYS_INLINE void transpose(Four& a, Four& b, Four& c, Four& d) {
  const Four e01 = __builtin_shufflevector(a, b, 0, 4, 2, 6), o01 = __builtin_shufflevector(a, b, 1, 5, 3, 7);
  const Four e23 = __builtin_shufflevector(c, d, 0, 4, 2, 6), o23 = __builtin_shufflevector(c, d, 1, 5, 3, 7);
  a = __builtin_shufflevector(e01, e23, 0, 1, 4, 5);
  b = __builtin_shufflevector(o01, o23, 0, 1, 4, 5);
  c = __builtin_shufflevector(e01, e23, 2, 3, 6, 7);
  d = __builtin_shufflevector(o01, o23, 2, 3, 6, 7);
}
EQUIDEM_ALWAYS_INLINE void transpose(Four (&m)[4]) {
  transpose(m[0], m[1], m[2], m[3]);
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

/// P(z) of atan t = t + t z P(z), z = t², |t| <= tan(pi/8): the best polynomial of degree 10 (relative error 2^-59
/// before rounding). \tparam Lanes vectors of any width
template <class Lanes>
EQUIDEM_ALWAYS_INLINE Lanes arctangent_series(const Lanes& z) {
  const Lanes z2 = z * z, z4 = z2 * z2;
  const Lanes low =
      (-0x1.555555555553dp-2 + z * 0x1.99999999957cdp-3) + z2 * (-0x1.24924922aa4e5p-3 + z * 0x1.c71c70e50e27dp-4);
  const Lanes middle =
      (-0x1.745cf8c36d549p-4 + z * 0x1.3b1117948652dp-4) + z2 * (-0x1.10eba8c075af4p-4 + z * 0x1.df0e7fb248f05p-5);
  const Lanes high = (-0x1.9ccf7cd2124b5p-5 + z * 0x1.37ce1ac095656p-5) - z2 * 0x1.255b341c4b7f1p-6;
  return low + z4 * (middle + z4 * high);
}

constexpr double tan_pi_8 = 0.41421356237309505;
constexpr double rest_of_pi_4 = 0x1.1a62633145c07p-55;  // pi/4 minus its double; without it errors grow by half an ulp

/// The angle of (x, y) in [-pi, pi], as std::atan2 to 2 ulp. Components between 1e-150 and 1e150 or 0.
///
/// By symmetry to the octant of t = smaller/larger in [0, 1], by tan(a - pi/4) = (t - 1)/(t + 1) to |t| <= tan(pi/8).
template <class Lanes>
EQUIDEM_ALWAYS_INLINE Lanes angle_of(const Lanes& x, const Lanes& y) {
  using std::numbers::pi;
  constexpr double smallest = 1e-300;
  const Lanes across = magnitude(x), up = magnitude(y);
  const Bits<Lanes> steep = negative(across - up);
  const Lanes larger = choose(steep, up, across), smaller = choose(steep, across, up);
  const Bits<Lanes> turned = negative(tan_pi_8 * larger - smaller);
  const Lanes t = choose(turned, smaller - larger, smaller) / (choose(turned, smaller + larger, larger) + smallest);
  const Lanes z = t * t;
  Lanes angle = t + (t * z * arctangent_series(z) + only(turned, all<Lanes>(rest_of_pi_4)));
  angle = choose(turned, pi / 4 + angle, angle);
  angle = choose(steep, pi / 2 - angle, angle);
  angle = choose(negative(x), pi - angle, angle);
  return as<Lanes>(bits_of(angle) ^ (bits_of(y) & std::numeric_limits<long long>::min()));
}

/// The angle modulo 2 pi, in [-pi, pi], with the error of an ulp of the argument. |angle| < 1e15.
/// \tparam Lanes vectors of any width
template <class Lanes>
EQUIDEM_ALWAYS_INLINE Lanes without_whole_turns(const Lanes& angle) {
  using std::numbers::pi;
  constexpr double to_integer = 0x1.8p52;  // adding it rounds to the nearest integer, the spacing of numbers there
  const Lanes turns = (angle * (0.5 / pi) + to_integer) - to_integer;
  return angle - turns * (2 * pi);
}

/// sin and 1 - cos of an angle, both to a few ulp of themselves where the angle is small and of 1 elsewhere. |angle| <
/// 1e15.
template <class Lanes>
struct SineVersine {
  Lanes sine, versine;
};

/// Polynomials for a quarter of the angle, in [-pi/4, pi/4] (sin a = a + a z S(z), 1 - cos a = z C(z), z = a²; relative
/// errors 2^-57 and 2^-64 before rounding), and twice sin 2a = 2 sin a cos a, 1 - cos 2a = 2 sin² a.
template <class Lanes>
EQUIDEM_ALWAYS_INLINE SineVersine<Lanes> sine_versine(const Lanes& angle) {
  const Lanes a = 0.25 * without_whole_turns(angle), z = a * a, z2 = z * z, z4 = z2 * z2;
  const Lanes sine_over =
      ((-0x1.5555555555548p-3 + z * 0x1.111111110f7d0p-7) + z2 * (-0x1.a01a019bfdefcp-13 + z * 0x1.71de3567d4223p-19)) +
      z4 * (-0x1.ae5e5a923db8ep-26 + z * 0x1.5d8fd1e48526bp-33);
  const Lanes versine_over =
      ((0.5 - z * 0x1.555555555553cp-5) + z2 * (0x1.6c16c16c13f18p-10 - z * 0x1.a01a019b6f8d7p-16)) +
      z4 * ((0x1.27e4f7537c614p-22 - z * 0x1.1ee984adbe1efp-29) + z2 * 0x1.8f806f1bab6fap-37);
  const Lanes sine = a + a * z * sine_over, versine = z * versine_over;
  const Lanes sine_2 = 2 * sine * (1 - versine), versine_2 = 2 * sine * sine;
  return {2 * sine_2 * (1 - versine_2), 2 * sine_2 * sine_2};
}

/// atan of |t| <= 1/64 with z = t²: t + t z P(z), P the best polynomial of degree 2 (relative error 2^-56 before
/// rounding).
/// \tparam Lanes vectors of any width
template <class Lanes>
EQUIDEM_ALWAYS_INLINE Lanes small_arctangent(const Lanes& t, const Lanes& z) {
  return t + t * z * ((-0x1.55555555551c7p-2 + z * 0x1.99999919a2fd7p-3) - z * z * 0x1.247cf5080565fp-3);
}

/// (1 - 1/sqrt(1 + z))/z for 0 <= z <= 1/64²: the best polynomial of degree 3 (relative error 2^-55).
template <class Lanes>
EQUIDEM_ALWAYS_INLINE Lanes small_shortening(const Lanes& z) {
  return (0.5 - z * 0x1.7ffffffffc107p-2) + z * z * (0x1.3ffffec520523p-2 - z * 0x1.17e082791cc03p-2);
}

#pragma GCC diagnostic pop

}  // namespace equidem::simd

namespace equidem {

/// Eight numbers, one for each pair of a group, in vectors as wide as those of the processor: an Eight, or fewer
/// numbers Twice.
namespace eight {
using namespace simd;
}

/// Vector width of loops that take it by template: all widths give bit-identical results.
enum class VectorWidth { bits_128, bits_256, bits_512 };

/// The widest allowed vectors of the processor (AVX-512 F, VL and DQ; AVX2).
VectorWidth vector_width();

/// Limit the width from the next simulation on, so that widths can be compared.
void allow_vectors_up_to(VectorWidth widest);

/// Kernel::run<Lanes> for vectors of the three widths, Lanes being the eight numbers; it is a static
/// function that is EQUIDEM_ALWAYS_INLINE.
template <class Kernel, class... Arguments>
void run_plain(Arguments... arguments) {
  Kernel::template run<eight::Twice<eight::Twice<eight::Two>>>(arguments...);
}
#if defined(__x86_64__)
template <class Kernel, class... Arguments>
EQUIDEM_BY_FOURS void run_by_fours(Arguments... arguments) {
  Kernel::template run<eight::Twice<eight::Four>>(arguments...);
}
template <class Kernel, class... Arguments>
EQUIDEM_BY_EIGHTS void run_by_eights(Arguments... arguments) {
  Kernel::template run<eight::Eight>(arguments...);
}
#endif

/// Kernel::run compiled for the widest allowed vectors. Sanitizers see one width alone: each takes minutes to compile,
/// and all do the same.
template <class Kernel, class... Arguments>
auto by_vector_width() -> void (*)(Arguments...) {
#if defined(__x86_64__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  if (vector_width() == VectorWidth::bits_512) return run_by_eights<Kernel, Arguments...>;
  if (vector_width() == VectorWidth::bits_256) return run_by_fours<Kernel, Arguments...>;
#endif
  return run_plain<Kernel, Arguments...>;
}

}  // namespace equidem
