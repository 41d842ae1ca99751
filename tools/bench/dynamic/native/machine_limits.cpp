// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cstddef>
#include <vector>

#include "bench.hpp"
#include "loops.hpp"

namespace equidem::bench {
namespace {

double triad_bandwidth() {
  constexpr std::size_t count = std::size_t{1} << 24;
  std::vector<double> a(count, 0.0), b(count, 1.0), c(count, 2.0);
  double best = 0;
  for (int round = 0; round < 7; ++round) {
    const double begin = processor_time();
    for (std::size_t i = 0; i < count; ++i) a[i] = b[i] + 0.5 * c[i];
    best = std::max(best, 24.0 * static_cast<double>(count) / (processor_time() - begin));
    b[static_cast<std::size_t>(round)] = a[count - 1];  // otherwise the compiler could omit rounds
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
    for (Lanes& sum : sums) asm volatile("" : "+m"(sum));  // otherwise the compiler could omit all of it
  }
  return best;
}

}  // namespace

Limits machine_limits() {
  return {.bandwidth = triad_bandwidth(), .arithmetic = peak_arithmetic()};
}

}  // namespace equidem::bench
