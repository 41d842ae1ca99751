// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/core/memory.hpp"

#include <cmath>
#include <vector>

#include "support/catch.hpp"

using namespace equidem;

#if defined(__SANITIZE_THREAD__)
constexpr double kept_beside = 4;  // bytes that the sanitizer keeps beside each
#else
constexpr double kept_beside = 0;
#endif

TEST_CASE("the_peak_of_memory_is_that_of_the_work_and_begins_anew") {
  constexpr std::size_t bytes = 64 << 20;
  const PeakMemory larger;
  const double taken = [&] {
    const std::vector<char> block(bytes, 1);
    return larger.bytes() + 0.0 * block[bytes / 2];
  }();
  const double afterwards = larger.bytes();
  const PeakMemory smaller;
  const std::vector<char> block(bytes / 8, 1);
  const double less = smaller.bytes() + 0.0 * block[bytes / 16];
  if (std::isnan(taken)) {
    WARN("the system does not tell the peak of memory");
    return;
  }
  CAPTURE(taken, afterwards, less);
  CHECK(taken > 0.9 * bytes);
  CHECK(taken < (1.2 + kept_beside) * bytes);
  CHECK(afterwards > 0.9 * bytes);
  CHECK(less > 0.9 * bytes / 8);
  CHECK(less < (2.0 + kept_beside) * bytes / 8);
}
