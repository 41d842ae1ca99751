// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Vectors of four numbers. Plain C++ with the vector types of GCC and Clang: the compiler selects the instructions.
/// Square root and angles of four numbers at once: no branches, no tables, bit-identical on every machine.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <numbers>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace equidem::lanes {

using Lanes = double __attribute__((vector_size(32)));
using Choice = long long __attribute__((vector_size(32)));
using Pair = double __attribute__((vector_size(16)));

#define EQUIDEM_INLINE inline __attribute__((always_inline))

EQUIDEM_INLINE void load(const double* from, Lanes& to) {
  std::memcpy(&to, from, sizeof to);
}
EQUIDEM_INLINE void store(const Lanes& from, double* to) {
  std::memcpy(to, &from, sizeof from);
}

/// The motions of four places as x, y(, theta) of four lanes.
template <int Width>
EQUIDEM_INLINE void gather(const double* motion, const std::int32_t* place, Lanes& x, Lanes& y, Lanes& theta) {
  if constexpr (Width == 4) {
    Lanes a, b, c, d;
    load(motion + 4 * static_cast<std::ptrdiff_t>(place[0]), a);
    load(motion + 4 * static_cast<std::ptrdiff_t>(place[1]), b);
    load(motion + 4 * static_cast<std::ptrdiff_t>(place[2]), c);
    load(motion + 4 * static_cast<std::ptrdiff_t>(place[3]), d);
    const Lanes xt_ab = __builtin_shufflevector(a, b, 0, 4, 2, 6), y_ab = __builtin_shufflevector(a, b, 1, 5, 3, 7);
    const Lanes xt_cd = __builtin_shufflevector(c, d, 0, 4, 2, 6), y_cd = __builtin_shufflevector(c, d, 1, 5, 3, 7);
    x = __builtin_shufflevector(xt_ab, xt_cd, 0, 1, 4, 5);
    y = __builtin_shufflevector(y_ab, y_cd, 0, 1, 4, 5);
    theta = __builtin_shufflevector(xt_ab, xt_cd, 2, 3, 6, 7);
  } else {
    const auto two = [&](int first, int second) {
      Pair low, high;
      std::memcpy(&low, motion + 2 * static_cast<std::ptrdiff_t>(place[first]), sizeof low);
      std::memcpy(&high, motion + 2 * static_cast<std::ptrdiff_t>(place[second]), sizeof high);
      return __builtin_shufflevector(low, high, 0, 1, 2, 3);
    };
    const Lanes ac = two(0, 2), bd = two(1, 3);
    x = __builtin_shufflevector(ac, bd, 0, 4, 2, 6);
    y = __builtin_shufflevector(ac, bd, 1, 5, 3, 7);
    theta = Lanes{};
  }
}

/// The motions of a group, whose places follow one another.
template <int Width>
EQUIDEM_INLINE void load_group(const double* motion, Lanes& x, Lanes& y, Lanes& theta) {
  constexpr std::int32_t place[] = {0, 1, 2, 3};
  gather<Width>(motion, place, x, y, theta);
}

template <int Width>
EQUIDEM_INLINE void store_group(const Lanes& x, const Lanes& y, const Lanes& theta, double* motion) {
  const Lanes even = __builtin_shufflevector(x, y, 0, 4, 2, 6), odd = __builtin_shufflevector(x, y, 1, 5, 3, 7);
  if constexpr (Width == 4) {
    const Lanes zero{};
    const Lanes theta_even = __builtin_shufflevector(theta, zero, 0, 4, 2, 6);
    const Lanes theta_odd = __builtin_shufflevector(theta, zero, 1, 5, 3, 7);
    store(__builtin_shufflevector(even, theta_even, 0, 1, 4, 5), motion);
    store(__builtin_shufflevector(odd, theta_odd, 0, 1, 4, 5), motion + 4);
    store(__builtin_shufflevector(even, theta_even, 2, 3, 6, 7), motion + 8);
    store(__builtin_shufflevector(odd, theta_odd, 2, 3, 6, 7), motion + 12);
  } else {
    store(__builtin_shufflevector(even, odd, 0, 1, 4, 5), motion);
    store(__builtin_shufflevector(even, odd, 2, 3, 6, 7), motion + 4);
  }
}

EQUIDEM_INLINE Choice sign_of(const Lanes& x) {
  return reinterpret_cast<Choice>(x) & std::numeric_limits<long long>::min();
}
/// x with its sign flipped if the sign bit of the other is set.
EQUIDEM_INLINE Lanes change_sign(const Lanes& x, const Choice& sign) {
  return reinterpret_cast<Lanes>(reinterpret_cast<Choice>(x) ^ sign);
}

/// Square root, correctly rounded (IEEE 754). x >= 0.
EQUIDEM_INLINE Lanes square_root(const Lanes& x) {
#if defined(__x86_64__)
  // In halves, which every such processor supports, without a round trip through memory.
  const Pair low = _mm_sqrt_pd(__builtin_shufflevector(x, x, 0, 1));
  const Pair high = _mm_sqrt_pd(__builtin_shufflevector(x, x, 2, 3));
  return __builtin_shufflevector(low, high, 0, 1, 2, 3);
#else
  Lanes root;
  for (int lane = 0; lane < 4; ++lane) root[lane] = std::sqrt(x[lane]);
  return root;
#endif
}

/// P(z) of atan t = t + t z P(z), z = t², |t| <= tan(pi/8): the best polynomial of degree 10 (relative error 2^-59
/// before rounding). \tparam Numbers vectors of any width
template <class Numbers>
EQUIDEM_INLINE Numbers arctangent_series(const Numbers& z) {
  const Numbers z2 = z * z, z4 = z2 * z2;
  const Numbers low =
      (-0x1.555555555553dp-2 + z * 0x1.99999999957cdp-3) + z2 * (-0x1.24924922aa4e5p-3 + z * 0x1.c71c70e50e27dp-4);
  const Numbers middle =
      (-0x1.745cf8c36d549p-4 + z * 0x1.3b1117948652dp-4) + z2 * (-0x1.10eba8c075af4p-4 + z * 0x1.df0e7fb248f05p-5);
  const Numbers high = (-0x1.9ccf7cd2124b5p-5 + z * 0x1.37ce1ac095656p-5) - z2 * 0x1.255b341c4b7f1p-6;
  return low + z4 * (middle + z4 * high);
}

constexpr double tan_pi_8 = 0.41421356237309505;
constexpr double rest_of_pi_4 = 0x1.1a62633145c07p-55;  // pi/4 minus its double; without it errors grow by half an ulp

/// The angle of (x, y) in [-pi, pi], as std::atan2 to 2 ulp; 0 of (0, 0). Components between 1e-150 and 1e150 or 0.
///
/// By symmetry to the octant of t = smaller/larger in [0, 1], by tan(a - pi/4) = (t - 1)/(t + 1) to |t| <= tan(pi/8).
EQUIDEM_INLINE Lanes angle_of(const Lanes& x, const Lanes& y) {
  using std::numbers::pi;
  constexpr double smallest = 1e-300;
  const Choice below = sign_of(y);
  const Lanes across = change_sign(x, sign_of(x)), up = change_sign(y, below);
  const Choice steep = up > across;
  const Lanes larger = steep ? up : across, smaller = steep ? across : up;
  const Choice turned = smaller > tan_pi_8 * larger;
  const Lanes t = (turned ? smaller - larger : smaller) / ((turned ? smaller + larger : larger) + smallest);
  const Lanes z = t * t;
  const Lanes zero{}, octant = zero + pi / 4, quadrant = zero + pi / 2, half_turn = zero + pi;
  Lanes angle = t + (t * z * arctangent_series(z) + (turned ? zero + rest_of_pi_4 : zero));
  angle = turned ? octant + angle : angle;
  angle = steep ? quadrant - angle : angle;
  angle = x < 0 ? half_turn - angle : angle;
  return change_sign(angle, below);
}

/// The angle modulo 2 pi, in [-pi, pi], with the error of an ulp of the argument. |angle| < 1e15.
/// \tparam Numbers vectors of any width
template <class Numbers>
EQUIDEM_INLINE Numbers without_whole_turns(const Numbers& angle) {
  using std::numbers::pi;
  constexpr double to_integer = 0x1.8p52;  // adding it rounds to the nearest integer, the spacing of numbers there
  const Numbers turns = (angle * (0.5 / pi) + to_integer) - to_integer;
  return angle - turns * (2 * pi);
}

/// sin and 1 - cos of an angle, both to a few ulp of themselves where the angle is small and of 1 elsewhere. |angle| <
/// 1e15.
struct SineVersine {
  Lanes sine, versine;
};

/// Polynomials for a quarter of the angle, in [-pi/4, pi/4] (sin a = a + a z S(z), 1 - cos a = z C(z), z = a²; relative
/// errors 2^-57 and 2^-64 before rounding), and twice sin 2a = 2 sin a cos a, 1 - cos 2a = 2 sin² a.
EQUIDEM_INLINE SineVersine sine_versine(const Lanes& angle) {
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
/// \tparam Numbers vectors of any width
template <class Numbers>
EQUIDEM_INLINE Numbers small_arctangent(const Numbers& t, const Numbers& z) {
  return t + t * z * ((-0x1.55555555551c7p-2 + z * 0x1.99999919a2fd7p-3) - z * z * 0x1.247cf5080565fp-3);
}

/// (1 - 1/sqrt(1 + z))/z for 0 <= z <= 1/64²: the best polynomial of degree 3 (relative error 2^-55).
EQUIDEM_INLINE Lanes small_shortening(const Lanes& z) {
  return (0.5 - z * 0x1.7ffffffffc107p-2) + z * z * (0x1.3ffffec520523p-2 - z * 0x1.17e082791cc03p-2);
}

}  // namespace equidem::lanes
