// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/linear/large_buffer.hpp"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstdlib>

#include <sys/mman.h>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

namespace equidem {

namespace {

constexpr std::size_t huge_page = std::size_t{1} << 21;
/// The allocator of the system reuses buffers of fewer numbers well enough.
constexpr std::size_t small_buffer = 1 << 14;

bool is_large(std::size_t bytes) {
  return bytes > huge_page;
}

std::size_t whole_pages(std::size_t bytes) {
  return (bytes + huge_page - 1) / huge_page * huge_page;
}

/// Address space that begins at a huge page; null where the system refuses it.
void* map(std::size_t bytes) {
  void* const found = mmap(nullptr, bytes + huge_page, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (found == MAP_FAILED) return nullptr;
  char* const begin = static_cast<char*>(found);
  const std::size_t skipped = (huge_page - reinterpret_cast<std::uintptr_t>(found) % huge_page) % huge_page;
  if (skipped > 0) munmap(begin, skipped);
  munmap(begin + skipped + bytes, huge_page - skipped);
  madvise(begin + skipped, bytes, MADV_HUGEPAGE);  // advice: nothing is lost where it is not taken
  return begin + skipped;
}

}  // namespace

void* allocate_large(std::size_t bytes) {
  const std::size_t size = is_large(bytes) ? whole_pages(bytes) : std::max<std::size_t>(bytes, 1);
  void* memory = is_large(bytes) ? map(size) : std::malloc(size);
  if (memory == nullptr) {
    out_of_memory(fmt::format("no memory for {}", readable_bytes(static_cast<double>(size))), "the system refused it",
                  "Use a smaller assembly or a machine with more memory");
  }
  return memory;
}

void free_large(void* memory, std::size_t bytes) {
  if (is_large(bytes)) {
    munmap(memory, whole_pages(bytes));
  } else {
    std::free(memory);
  }
}

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
