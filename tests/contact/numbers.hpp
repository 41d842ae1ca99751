// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Numbers shared by the tests of contacts.
#pragma once

#include <cmath>
#include <limits>

#include "equidem/core/random.hpp"

namespace equidem::test {

inline constexpr double epsilon = std::numeric_limits<double>::epsilon();

/// The widest floating-point number that the compiler has.
#ifdef __SIZEOF_FLOAT128__
__extension__ using Quad = __float128;
#else
using Quad = long double;
#endif

/// A random number within so many decades of 1.
inline double magnitude(double decades, Random& random) {
  return std::pow(10.0, random.uniform(-decades, decades));
}

}  // namespace equidem::test
