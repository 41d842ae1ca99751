// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Sums over all contacts.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "equidem/core/threads.hpp"

namespace equidem {

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

}  // namespace equidem
