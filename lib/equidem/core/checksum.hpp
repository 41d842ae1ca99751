// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Checksum that detects changes of data.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "equidem/core/text.hpp"

namespace equidem {

/// FNV-1a (Fowler, Noll & Vo), 64 bits. Not a protection against forgery.
class Checksum {
 public:
  /// A change of a single byte always changes the sum.
  void add(std::span<const std::byte> bytes) {
    for (const std::byte byte : bytes) sum_ = (sum_ ^ static_cast<std::uint64_t>(byte)) * prime;
  }
  /// All 64 bits at once, the upper ones folded down.
  void add(std::uint64_t value) {
    sum_ = (sum_ ^ value) * prime;
    sum_ ^= sum_ >> 32U;
  }
  void add(double value) { add(std::bit_cast<std::uint64_t>(value)); }
  void add(const std::vector<double>& values) {
    for (const double value : values) add(value);
  }
  [[nodiscard]] std::uint64_t value() const { return sum_; }
  [[nodiscard]] std::string text() const { return fmt::format("{:016x}", sum_); }

 private:
  static constexpr std::uint64_t prime = 0x100000001b3U;
  std::uint64_t sum_ = 0xcbf29ce484222325U;
};

}  // namespace equidem
