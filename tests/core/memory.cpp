// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/core/memory.hpp"

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <memory>
#include <new>
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

// Sanitizers bring their own operator new, and end the process where there is not enough memory.
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
TEST_CASE("large_arrays_begin_at_a_huge_page_and_what_does_not_fit_is_refused") {
  constexpr std::uintptr_t huge_page = std::uintptr_t{1} << 21;
  for (const std::size_t bytes : {huge_page + 1, 3 * huge_page, 40 * huge_page + 17}) {
    const std::vector<char> array(bytes);
    CHECK(reinterpret_cast<std::uintptr_t>(array.data()) % huge_page == 0);
  }
  const auto freed = [](void* memory) { std::free(memory); };
  const std::unique_ptr<void, decltype(freed)> none(allocate_on_huge_pages(0), freed);
  CHECK(none != nullptr);
  const std::size_t most = std::numeric_limits<std::size_t>::max() / 4;
  CHECK(allocate_on_huge_pages(most) == nullptr);
  CHECK_THROWS_AS(::operator new(most), std::bad_alloc);
}
#endif
