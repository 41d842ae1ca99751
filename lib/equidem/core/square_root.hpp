// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The square root of a number, or of each of the eight numbers of a vector.
#pragma once

#include <cmath>
#include <type_traits>

namespace equidem {

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wpsabi"  // vectors are passed between inlined functions only
/// Correctly rounded. The compiler makes one instruction of eight roots where the processor has one.
/// \tparam Number double, or a vector of eight doubles (the vector extension of GCC and Clang)
template <class Number>
[[gnu::always_inline]] inline Number square_root(const Number& x) {
  if constexpr (std::is_floating_point_v<Number>) {
    return std::sqrt(x);
  } else {
    return Number{std::sqrt(x[0]), std::sqrt(x[1]), std::sqrt(x[2]), std::sqrt(x[3]),
                  std::sqrt(x[4]), std::sqrt(x[5]), std::sqrt(x[6]), std::sqrt(x[7])};
  }
}
#pragma GCC diagnostic pop

}  // namespace equidem
