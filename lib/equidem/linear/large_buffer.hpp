// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Memory for arrays of gigabytes.
#pragma once

#include <cstddef>
#include <map>
#include <mutex>
#include <new>
#include <utility>
#include <vector>

namespace equidem {

/// Uninitialized memory. Where it is large it comes from the system, on huge pages if there are any, and goes back to
/// it when freed: kept by the allocator, it would lie beside the next array of gigabytes.
/// \throws Error (computation_failed) where there is not enough
void* allocate_large(std::size_t bytes);
/// \param bytes as allocated
void free_large(void* memory, std::size_t bytes);

/// Memory of a LargeVector. Its pages are first touched by the threads that fill it.
template <typename T>
struct UntouchedAllocator {
  using value_type = T;  // NOLINT(readability-identifier-naming): the standard library requires this name
  UntouchedAllocator() = default;
  template <typename U>
  explicit UntouchedAllocator(const UntouchedAllocator<U>&) {}
  T* allocate(std::size_t count) { return static_cast<T*>(allocate_large(count * sizeof(T))); }
  void deallocate(T* memory, std::size_t count) { free_large(memory, count * sizeof(T)); }
  template <typename U>
  void construct(U* place) {
    ::new (static_cast<void*>(place)) U;  // no value: a resize leaves numbers as they are
  }
  template <typename U, typename... Values>
  void construct(U* place, Values&&... values) {
    ::new (static_cast<void*>(place)) U(std::forward<Values>(values)...);
  }
  bool operator==(const UntouchedAllocator&) const = default;
};

/// A vector whose resize leaves new elements uninitialized, on huge pages where the system has them: the first touch of
/// small pages would cost a good part of a factorization.
template <typename T>
using LargeVector = std::vector<T, UntouchedAllocator<T>>;

/// Pool of reusable buffers: fresh memory is slow to touch. Safe to use from several threads.
class BufferPool {
 public:
  using Buffer = LargeVector<double>;
  /// At least that many numbers, uninitialized.
  Buffer take(std::size_t numbers);
  void give_back(Buffer&& buffer);
  /// Free what is idle.
  void clear();

 private:
  std::mutex mutex_;
  std::multimap<std::size_t, Buffer> idle_;  // by size
};

}  // namespace equidem
