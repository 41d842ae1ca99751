// SPDX-License-Identifier: GPL-3.0-or-later
#include "contender.hpp"

#include <algorithm>
#include <utility>

#include "equidem/core/stopwatch.hpp"
#include "equidem/core/threads.hpp"

#include "processor_time.hpp"

namespace equidem::bench {

std::vector<Seconds> take_turns(std::span<const Entry> entries, std::int64_t steps, int rounds) {
  std::vector<Seconds> seconds(entries.size());
  for (int round = -1; round < rounds; ++round) {
    for (std::size_t k = 0; k < entries.size(); ++k) {
      set_thread_count(entries[k].threads);
      const Stopwatch watch;
      const double begin = processor_time();
      entries[k].advance(steps);
      const double taken = entries[k].threads == 1 ? processor_time() - begin : watch.seconds();
      if (round >= 0) seconds[k].push_back(taken);
    }
  }
  set_thread_count(1);
  return seconds;
}

Range range_of(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  return {0.5 * (values[(n - 1) / 2] + values[n / 2]), values.front(), values.back()};
}

Range ratio_of(const Seconds& a, const Seconds& b) {
  std::vector<double> ratios(a.size());
  for (std::size_t k = 0; k < a.size(); ++k) ratios[k] = a[k] / b[k];
  return range_of(std::move(ratios));
}

}  // namespace equidem::bench
