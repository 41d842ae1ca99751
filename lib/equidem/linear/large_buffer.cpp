// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/linear/large_buffer.hpp"

#include <bit>

namespace equidem {

namespace {

/// The allocator of the system reuses buffers of fewer numbers well enough.
constexpr std::size_t small_buffer = 1 << 14;

}  // namespace

LargeVector<double> BufferPool::take(std::size_t numbers) {
  if (numbers < small_buffer) return Buffer(numbers);
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

void BufferPool::give_back(Buffer&& buffer) {
  Buffer taken = std::move(buffer);
  if (taken.size() < small_buffer) return;
  const std::lock_guard lock(mutex_);
  idle_.emplace(taken.size(), std::move(taken));
}

void BufferPool::clear() {
  const std::lock_guard lock(mutex_);
  idle_.clear();
}

}  // namespace equidem
