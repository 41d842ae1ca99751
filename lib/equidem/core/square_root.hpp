// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The square root of a number, or of each number of a vector.
#pragma once

#include <cmath>
#include <type_traits>

namespace equidem {

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wpsabi"  // vectors are passed between inlined functions only
/// Correctly rounded. The compiler makes one instruction of all roots of a vector where the processor has one.
/// \tparam Number double, or a vector of one, two, four or eight doubles (the vector extension of GCC and Clang)
template <class Number>
[[gnu::always_inline]] inline Number square_root(const Number& x) {
  if constexpr (std::is_floating_point_v<Number>) {
    return std::sqrt(x);
  } else if constexpr (sizeof(Number) == sizeof(double)) {
    return Number{std::sqrt(x[0])};
  } else if constexpr (sizeof(Number) == 2 * sizeof(double)) {
    return Number{std::sqrt(x[0]), std::sqrt(x[1])};
  } else if constexpr (sizeof(Number) == 4 * sizeof(double)) {
    return Number{std::sqrt(x[0]), std::sqrt(x[1]), std::sqrt(x[2]), std::sqrt(x[3])};
  } else {
    static_assert(sizeof(Number) == 8 * sizeof(double));
    return Number{std::sqrt(x[0]), std::sqrt(x[1]), std::sqrt(x[2]), std::sqrt(x[3]),
                  std::sqrt(x[4]), std::sqrt(x[5]), std::sqrt(x[6]), std::sqrt(x[7])};
  }
}
#pragma GCC diagnostic pop

}  // namespace equidem
