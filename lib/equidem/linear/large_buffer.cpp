// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/linear/large_buffer.hpp"

#include <algorithm>
#include <bit>
#include <cstdlib>

#include <sys/mman.h>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

namespace equidem {

void* allocate_large(std::size_t bytes) {
  constexpr std::size_t huge_page = std::size_t{1} << 21;
  const bool large = bytes > huge_page;
  const std::size_t rounded = large ? (bytes + huge_page - 1) / huge_page * huge_page : std::max<std::size_t>(bytes, 1);
  void* memory = large ? std::aligned_alloc(huge_page, rounded) : std::malloc(rounded);
  if (memory == nullptr) {
    computation_failed(fmt::format("no memory for {}", readable_bytes(static_cast<double>(rounded))),
                       "the system refused it", "Use a smaller assembly or a machine with more memory");
  }
  if (large) madvise(memory, rounded, MADV_HUGEPAGE);  // advice: nothing is lost where it is not taken
  return memory;
}

void free_large(void* memory) {
  std::free(memory);
}

template <typename Real>
LargeVector<Real> BufferPool<Real>::take(std::size_t numbers) {
  constexpr std::size_t small = 1 << 14;  // the allocator of the system reuses these well enough
  if (numbers < small) return Buffer(numbers);
  // Sizes in steps of an eighth, so that a buffer fits again.
  const std::size_t step = std::bit_floor(numbers) / 8;
  const std::size_t size = (numbers + step - 1) / step * step;
  {
    const std::lock_guard lock(mutex_);
    const auto found = idle_.lower_bound(size);
    if (found != idle_.end() && found->first <= 2 * size) {
      Buffer buffer = std::move(found->second);
      idle_.erase(found);
      return buffer;
    }
  }
  return Buffer(size);
}

template <typename Real>
void BufferPool<Real>::give_back(Buffer&& buffer) {
  Buffer taken = std::move(buffer);
  if (taken.size() == 0) return;
  const std::lock_guard lock(mutex_);
  idle_.emplace(taken.size(), std::move(taken));
}

template <typename Real>
void BufferPool<Real>::clear() {
  const std::lock_guard lock(mutex_);
  idle_.clear();
}

template class BufferPool<float>;
template class BufferPool<double>;

}  // namespace equidem
