// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Sines with the same bits on every machine.
#pragma once

#include <cmath>
#include <numbers>

namespace equidem {

/// sin(2 pi x) to 1e-15: its Taylor series on a quarter of a turn. Mathematical libraries differ in the last bits.
/// \param x turns
inline double sine_of_turns(double x) {
  x -= std::round(x);
  if (std::abs(x) > 0.25) x = std::copysign(0.5, x) - x;
  const double y = 2 * std::numbers::pi * x;
  double sum = 1;
#pragma GCC unroll 11
  for (int k = 22; k >= 2; k -= 2) sum = 1 - y * y * (1.0 / (k * (k + 1))) * sum;
  return y * sum;
}

}  // namespace equidem
