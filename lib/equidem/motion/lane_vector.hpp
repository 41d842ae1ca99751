// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Aligned memory for the arrays of vectorized loops.
#pragma once

#include <cstddef>
#include <cstdlib>
#include <new>
#include <vector>

#include "equidem/core/memory.hpp"

namespace equidem {

/// Memory aligned to a cache line, so that no vector of four numbers crosses a line; large arrays use huge pages if the
/// system provides them.
template <typename T>
struct LaneAllocator {
  using value_type = T;  // NOLINT(readability-identifier-naming): the standard library requires this name
  static constexpr std::size_t cache_line = 64, large = std::size_t{1} << 22;

  LaneAllocator() = default;
  template <typename U>
  explicit LaneAllocator(const LaneAllocator<U>&) {}
  T* allocate(std::size_t count) {
    const std::size_t bytes = count * sizeof(T);
    if (bytes >= large) return static_cast<T*>(allocate_large(bytes));
    return static_cast<T*>(::operator new (bytes, std::align_val_t{cache_line}));
  }
  void deallocate(T* memory, std::size_t count) {
    if (count * sizeof(T) >= large) return std::free(memory);
    ::operator delete (memory, std::align_val_t{cache_line});
  }
  bool operator==(const LaneAllocator&) const = default;
};

template <typename T>
using LaneVector = std::vector<T, LaneAllocator<T>>;

}  // namespace equidem
