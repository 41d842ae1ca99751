// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Waiting of one thread for another.
#pragma once

#include <atomic>

namespace equidem {

/// Wait until `value` is another than `old`; whoever changes it notifies.
///
/// It spins for some ten microseconds, longer than threads that work together wait for one another, and then sleeps:
/// where others have the processor, spinning would take it from the thread that is waited for.
inline void wait_while_equal(const std::atomic<int>& value, int old) {
  constexpr int spins = 2000;
  for (int k = 0; k < spins; ++k) {
    if (value.load(std::memory_order_acquire) != old) return;
#if defined(__x86_64__)
    __builtin_ia32_pause();
#endif
  }
  value.wait(old, std::memory_order_acquire);
}

}  // namespace equidem
