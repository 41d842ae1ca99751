// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <ctime>

namespace equidem::bench {

/// Seconds that this thread has computed: the time in which others had the processor does not count.
inline double processor_time() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace equidem::bench
