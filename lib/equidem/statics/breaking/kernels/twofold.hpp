// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Numbers as unevaluated sums of two doubles, about 106 bits of mantissa, without fused operations: the same bits on
/// every processor.
#pragma once

namespace equidem {

/// high + low with |low| at most half a unit in the last place of high. \tparam Number double, or a vector of them
template <typename Number>
struct Twofold {
  Number high{}, low{};
};

namespace twofold {

#define EQUIDEM_INLINE inline __attribute__((always_inline))

/// a + b, exactly where neither overflows (Knuth, The Art of Computer Programming 2, section 4.2.2, theorem B).
template <typename Number>
EQUIDEM_INLINE Twofold<Number> sum(const Number& a, const Number& b) {
  const Number s = a + b, from_b = s - a;
  return {s, (a - (s - from_b)) + (b - from_b)};
}

/// Likewise where |a| >= |b| or a = 0 (Dekker 1971).
template <typename Number>
EQUIDEM_INLINE Twofold<Number> ordered_sum(const Number& a, const Number& b) {
  const Number s = a + b;
  return {s, b - (s - a)};
}

/// a b, exactly in the absence of overflow and underflow (Dekker 1971, by the halves of Veltkamp).
template <typename Number>
EQUIDEM_INLINE Twofold<Number> product(const Number& a, const Number& b) {
  constexpr double split = 134217729;  // 2^27 + 1
  const Number big_a = split * a, big_b = split * b;
  const Number a_high = big_a - (big_a - a), b_high = big_b - (big_b - b);
  const Number a_low = a - a_high, b_low = b - b_high, p = a * b;
  return {p, ((a_high * b_high - p) + a_high * b_low + a_low * b_high) + a_low * b_low};
}

}  // namespace twofold

template <typename Number>
EQUIDEM_INLINE Twofold<Number> operator+(const Twofold<Number>& a, const Twofold<Number>& b) {
  const Twofold<Number> s = twofold::sum(a.high, b.high);
  return twofold::ordered_sum<Number>(s.high, s.low + (a.low + b.low));
}

template <typename Number>
EQUIDEM_INLINE Twofold<Number> operator-(const Twofold<Number>& a, const Twofold<Number>& b) {
  return a + Twofold<Number>{-b.high, -b.low};
}

template <typename Number>
EQUIDEM_INLINE Twofold<Number> operator*(const Twofold<Number>& a, const Number& b) {
  const Twofold<Number> p = twofold::product(a.high, b);
  return twofold::ordered_sum<Number>(p.high, p.low + a.low * b);
}

template <typename Number>
EQUIDEM_INLINE Twofold<Number> operator*(const Twofold<Number>& a, const Twofold<Number>& b) {
  const Twofold<Number> p = twofold::product(a.high, b.high);
  return twofold::ordered_sum<Number>(p.high, p.low + (a.high * b.low + a.low * b.high));
}

/// 1/a, to some units of the last place of `low` (one step of Newton).
template <typename Number>
EQUIDEM_INLINE Twofold<Number> inverse(const Number& a) {
  const Number first = 1 / a;
  const Twofold<Number> p = twofold::product(a, first);
  return {first, ((1 - p.high) - p.low) * first};
}

#undef EQUIDEM_INLINE

}  // namespace equidem
