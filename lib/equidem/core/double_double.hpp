// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Numbers of twice the digits of a double: the unevaluated sum of two, of which the first is the sum rounded.
///
/// The rounding of a sum of two doubles is itself a double, found without a branch (Knuth, The Art of Computer
/// Programming 2, 4.2.2, theorem B); so is that of a product, from factors split in halves of 26 digits (Dekker 1971,
/// Numer. Math. 18, 224) or, in a third of the time, from a product that is fused with a sum. The errors of the
/// operations below are at most 2^-104 of the sum of the magnitudes that enter; the bits are the same on every machine,
/// with fused products and without.
#pragma once

#include <cmath>
#include <type_traits>

namespace equidem {

/// \tparam fused for functions that are compiled for processors with fused multiply-add
template <bool fused>
class DoubleDoubleOf {
 public:
  constexpr DoubleDoubleOf() = default;
  constexpr DoubleDoubleOf(double value) : high_(value) {}  // NOLINT(google-explicit-constructor): exact
  /// A number by its two parts. Precondition: high is their sum rounded.
  constexpr DoubleDoubleOf(double high, double low) : high_(high), low_(low) {}
  /// The sum of two doubles of any sizes, exactly.
  static constexpr DoubleDoubleOf sum(double a, double b) {
    const double s = a + b;
    const double of_b = s - a;
    return {s, (a - (s - of_b)) + (b - of_b)};
  }
  /// The product of two doubles, exactly as long as no part of it is below 1e-292 or factor above 1e300.
  static constexpr DoubleDoubleOf product(double a, double b) {
    const double p = a * b;
    if constexpr (fused) {
      return {p, std::fma(a, b, -p)};
    } else {
      const auto [a1, a2] = halves_of(a);
      const auto [b1, b2] = halves_of(b);
      return {p, ((a1 * b1 - p) + a1 * b2 + a2 * b1) + a2 * b2};
    }
  }

  template <bool other>
  constexpr explicit DoubleDoubleOf(const DoubleDoubleOf<other>& same) : high_(same.high()), low_(same.low()) {}

  /// The sum rounded to a double, and what the rounding leaves.
  [[nodiscard]] constexpr double high() const { return high_; }
  [[nodiscard]] constexpr double low() const { return low_; }
  constexpr explicit operator double() const { return high_; }

  friend constexpr DoubleDoubleOf operator-(const DoubleDoubleOf& a) { return {-a.high_, -a.low_}; }
  friend constexpr DoubleDoubleOf operator+(const DoubleDoubleOf& a, const DoubleDoubleOf& b) {
    const DoubleDoubleOf s = sum(a.high_, b.high_);
    return ordered(s.high_, s.low_ + (a.low_ + b.low_));
  }
  friend constexpr DoubleDoubleOf operator-(const DoubleDoubleOf& a, const DoubleDoubleOf& b) { return a + -b; }
  friend constexpr DoubleDoubleOf operator*(double a, const DoubleDoubleOf& b) {
    const DoubleDoubleOf p = product(a, b.high_);
    return ordered(p.high_, p.low_ + a * b.low_);
  }
  friend constexpr DoubleDoubleOf operator*(const DoubleDoubleOf& a, double b) { return b * a; }
  friend constexpr DoubleDoubleOf operator/(const DoubleDoubleOf& a, double b) {
    const double q = a.high_ / b;
    const DoubleDoubleOf left = a - product(q, b);
    return ordered(q, left.high_ / b);
  }
  constexpr DoubleDoubleOf& operator+=(const DoubleDoubleOf& b) { return *this = *this + b; }
  constexpr DoubleDoubleOf& operator-=(const DoubleDoubleOf& b) { return *this = *this - b; }

 private:
  struct Halves {
    double upper, lower;
  };

  /// The sum of two doubles of which the first is the larger one.
  static constexpr DoubleDoubleOf ordered(double large, double small) {
    const double s = large + small;
    return {s, small - (s - large)};
  }
  static constexpr Halves halves_of(double a) {
    const double shifted = 0x1p27 * a + a;
    const double upper = shifted - (shifted - a);
    return {upper, a - upper};
  }

  double high_ = 0, low_ = 0;
};

using DoubleDouble = DoubleDoubleOf<false>;

#if defined(__x86_64__)
template <class Loop>
__attribute__((target("avx2,fma"), flatten)) auto with_fused_double_doubles(const Loop& loop) {
  return loop(std::type_identity<DoubleDoubleOf<true>>());
}
#endif

/// Calls loop(std::type_identity<Number>()), compiled for this processor, with the Number that it is fastest at.
template <class Loop>
auto with_double_doubles(const Loop& loop) {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return with_fused_double_doubles(loop);
#endif
  return loop(std::type_identity<DoubleDouble>());
}

}  // namespace equidem
