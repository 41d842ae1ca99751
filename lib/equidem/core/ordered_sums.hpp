// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Sums over vectors whose order does not depend on the number of threads.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "equidem/core/threads.hpp"

namespace equidem {

/// The sums of f(begin, end), an array of numbers, over pieces of the range.
template <std::size_t Numbers, typename Function>
std::array<double, Numbers> sums_over(std::size_t count, std::size_t at_once, const Function& f) {
  std::vector<std::array<double, Numbers>> parts((count + at_once - 1) / at_once);
  parallel_ranges(count, at_once, [&](std::size_t begin, std::size_t end) { parts[begin / at_once] = f(begin, end); });
  std::array<double, Numbers> sums{};
  for (const auto& part : parts) {
    for (std::size_t k = 0; k < Numbers; ++k) sums[k] += part[k];
  }
  return sums;
}

}  // namespace equidem
