// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Rings of contacts around a period, and the directions that they span.
#pragma once

#include <algorithm>
#include <cstdint>

namespace equidem {

/// Multiples of the period.
struct Shift {
  std::int32_t x = 0;
  std::int32_t y = 0;

  [[nodiscard]] bool zero() const { return x == 0 && y == 0; }
};

/// Number of directions that the windings found so far span.
struct Span {
  Shift first;
  int rank = 0;

  void add(Shift winding) {
    if (rank == 0) first = winding;
    const std::int64_t area = std::int64_t{first.x} * winding.y - std::int64_t{first.y} * winding.x;
    rank = std::max(rank, area != 0 ? 2 : 1);
  }
};

}  // namespace equidem
