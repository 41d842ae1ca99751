// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// What is timed: somebody who steps an assembly of discs, side by side with others.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace equidem::bench {

class Contender {
 public:
  Contender() = default;
  virtual ~Contender() = default;
  Contender(const Contender&) = delete;
  Contender& operator=(const Contender&) = delete;

  virtual void advance(std::int64_t steps) = 0;
  /// Sum of the squares of all velocities, to see that contenders do the same.
  [[nodiscard]] virtual double activity() const = 0;
};

struct Entry {
  std::string label;
  std::function<void(std::int64_t steps)> advance;
  int threads = 1;
};

/// Seconds per round: of the processor with one thread, by the clock with more.
using Seconds = std::vector<double>;

/// Every round all entries in turn make so many steps; one round before the first is not counted.
std::vector<Seconds> take_turns(std::span<const Entry> entries, std::int64_t steps, int rounds);

struct Range {
  double median = 0, smallest = 0, largest = 0;
};
Range range_of(std::vector<double> values);
/// a over b, round by round.
Range ratio_of(const Seconds& a, const Seconds& b);

}  // namespace equidem::bench
