// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Sums over vectors whose order does not depend on the number of threads.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
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

/// N sums over [0, count) at once: add(index, sums) adds the terms of one index. Partial sums of a fixed length are
/// added in order: the same bits for every number of threads, and rounding errors that grow far slower than in one
/// long sum.
template <std::size_t N, typename Add>
std::array<double, N> contact_sums(std::size_t count, const Add& add) {
  constexpr std::size_t block = 4096, run = 64;  // equal terms round to the same side: no long run of them
  std::vector<std::array<double, N>> partial((count + block - 1) / block);
  parallel_tasks(partial.size(), [&](std::size_t task, int) {
    const std::size_t end = std::min(count, (task + 1) * block);
    for (std::size_t index = task * block; index < end;) {
      std::array<double, N> sums{};
      for (const std::size_t stop = std::min(end, index + run); index < stop; ++index) add(index, sums);
      for (std::size_t k = 0; k < N; ++k) partial[task][k] += sums[k];
    }
  });
  std::array<double, N> total{};
  for (const auto& sums : partial) {
    for (std::size_t k = 0; k < N; ++k) total[k] += sums[k];
  }
  return total;
}

/// Term by term, on the calling thread.
inline double dot(std::span<const double> a, std::span<const double> b) {
  double sum = 0;
  for (std::size_t k = 0; k < a.size(); ++k) sum += a[k] * b[k];
  return sum;
}

}  // namespace equidem
