// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Memory for arrays of gigabytes.
#pragma once

#include <cstddef>
#include <cstdlib>
#include <map>
#include <mutex>
#include <new>
#include <utility>
#include <vector>

#include "equidem/core/memory.hpp"

namespace equidem {

/// Memory of a LargeVector. Its pages are first touched by the threads that fill it.
template <typename T>
struct UntouchedAllocator {
  using value_type = T;  // NOLINT(readability-identifier-naming): the standard library requires this name
  UntouchedAllocator() = default;
  template <typename U>
  explicit UntouchedAllocator(const UntouchedAllocator<U>&) {}
  T* allocate(std::size_t count) { return static_cast<T*>(allocate_large(count * sizeof(T))); }
  void deallocate(T* memory, std::size_t /*count*/) { std::free(memory); }
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

/// A vector whose resize leaves new elements uninitialized.
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
