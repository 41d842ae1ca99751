// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/study/timing.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <ctime>
#include <limits>
#include <vector>

#include "equidem/core/stopwatch.hpp"

namespace equidem {

double Timing::relative_error() const {
  if (repetitions < 3 || !(median > 0)) return std::numeric_limits<double>::infinity();
  return 1.2533 / 1.349 * (upper_quartile - lower_quartile) / (median * std::sqrt(repetitions));
}

double quantile(std::span<const double> sorted, double share) {
  assert(!sorted.empty() && share >= 0 && share <= 1);
  const double at = share * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(at);
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  return std::lerp(sorted[below], sorted[above], at - static_cast<double>(below));
}

Timing summarize(std::span<const TimeSample> samples) {
  if (samples.empty()) return {};
  std::vector<double> wall, processor;
  for (const TimeSample& sample : samples) {
    wall.push_back(sample.seconds);
    processor.push_back(sample.processor_seconds);
  }
  std::sort(wall.begin(), wall.end());
  std::sort(processor.begin(), processor.end());
  return {.median = quantile(wall, 0.5),
          .lower_quartile = quantile(wall, 0.25),
          .upper_quartile = quantile(wall, 0.75),
          .processor_median = quantile(processor, 0.5),
          .repetitions = static_cast<int>(samples.size())};
}

double thread_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

TimeSample time_work(const std::function<std::function<void()>()>& prepare, double least) {
  constexpr int most = 1000;
  TimeSample sum;
  int times = 0;
  while (times == 0 || (sum.seconds < least && times < most)) {
    const std::function<void()> work = prepare();
    const double processor = thread_seconds();
    const Stopwatch watch;
    work();
    sum.seconds += watch.seconds();
    sum.processor_seconds += thread_seconds() - processor;
    ++times;
  }
  return {sum.seconds / times, sum.processor_seconds / times};
}

}  // namespace equidem
