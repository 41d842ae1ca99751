// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Memory for arrays of gigabytes.
#pragma once

#include <cstddef>
#include <map>
#include <mutex>

namespace equidem {

/// Uninitialized doubles on huge pages where the system has them: the first touch of small pages would cost a good
/// part of a factorization.
class LargeBuffer {
 public:
  LargeBuffer() = default;
  /// \throws Error (computation_failed) where there is not enough memory
  explicit LargeBuffer(std::size_t doubles);
  ~LargeBuffer();
  LargeBuffer(LargeBuffer&& other) noexcept;
  LargeBuffer& operator=(LargeBuffer&& other) noexcept;

  [[nodiscard]] double* data() const { return data_; }
  [[nodiscard]] std::size_t size() const { return size_; }

 private:
  double* data_ = nullptr;
  std::size_t size_ = 0;
};

/// Buffers that come and go, kept for reuse: fresh memory is slow to touch. Safe to use from several threads.
class BufferPool {
 public:
  /// At least that many doubles, uninitialized.
  LargeBuffer take(std::size_t doubles);
  void give_back(LargeBuffer&& buffer);
  /// Free what is idle.
  void clear();

 private:
  std::mutex mutex_;
  std::multimap<std::size_t, LargeBuffer> idle_;  // by size
};

}  // namespace equidem
