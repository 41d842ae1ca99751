// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Vectors of four numbers. Plain C++ with the vector types of GCC and Clang: the compiler selects the instructions.
#pragma once

#include <cstdint>
#include <cstring>

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

}  // namespace equidem::lanes
