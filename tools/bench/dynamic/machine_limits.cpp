// SPDX-License-Identifier: GPL-3.0-or-later
#include "machine_limits.hpp"

#include <algorithm>
#include <cstddef>
#include <vector>

#include "processor_time.hpp"

namespace equidem::bench {

double triad_bandwidth() {
  constexpr std::size_t count = std::size_t{1} << 24;
  std::vector<double> a(count, 0.0), b(count, 1.0), c(count, 2.0);
  double best = 0;
  for (int round = 0; round < 7; ++round) {
    const double begin = processor_time();
    for (std::size_t i = 0; i < count; ++i) a[i] = b[i] + 0.5 * c[i];
    best = std::max(best, 24.0 * static_cast<double>(count) / (processor_time() - begin));
    b[static_cast<std::size_t>(round)] = a[count - 1];  // or else the compiler could leave rounds out
  }
  return best;
}

double peak_arithmetic() {
  using Lanes = double __attribute__((vector_size(32)));
  constexpr int chains = 10, repetitions = 4'000'000;
  Lanes sums[chains] = {};
  double best = 0;
  for (int round = 0; round < 7; ++round) {
    const double begin = processor_time();
    for (int k = 0; k < repetitions; ++k) {
#pragma GCC unroll 10
      for (Lanes& sum : sums) sum = sum * 0.999 + 0.001;
    }
    best = std::max(best, 8.0 * chains * repetitions / (processor_time() - begin));
    for (Lanes& sum : sums) asm volatile("" : "+m"(sum));  // or else nothing of it would be computed
  }
  return best;
}

}  // namespace equidem::bench
