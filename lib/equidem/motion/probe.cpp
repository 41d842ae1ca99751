// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/motion/probe.hpp"

namespace equidem {

void Oscillation::add(double time, double value) {
  if (samples_++ > 0 && (value_ < 0) != (value < 0)) {
    const double passage = time_ + (time - time_) * value_ / (value_ - value);
    if (passages_++ == 0) {
      first_ = passage;
    } else {
      const double between = passage - last_;
      shortest_ = passages_ == 2 ? between : std::min(shortest_, between);
      longest_ = std::max(longest_, between);
    }
    last_ = passage;
  }
  time_ = time;
  value_ = value;
}

std::optional<double> Oscillation::period() const {
  if (passages_ < 2) return std::nullopt;
  return 2 * (last_ - first_) / static_cast<double>(passages_ - 1);
}

std::optional<double> Oscillation::spread() const {
  if (passages_ < 2) return std::nullopt;
  const double mean = *period() / 2;
  return std::max(longest_ - mean, mean - shortest_) / mean;
}

std::array<double, Oscillation::saved> Oscillation::save() const {
  return {
      static_cast<double>(samples_), static_cast<double>(passages_), time_, value_, first_, last_, shortest_, longest_};
}

Oscillation Oscillation::restored(std::span<const double, saved> state) {
  Oscillation result;
  result.samples_ = static_cast<std::int64_t>(state[0]);
  result.passages_ = static_cast<std::int64_t>(state[1]);
  result.time_ = state[2];
  result.value_ = state[3];
  result.first_ = state[4];
  result.last_ = state[5];
  result.shortest_ = state[6];
  result.longest_ = state[7];
  return result;
}

}  // namespace equidem
