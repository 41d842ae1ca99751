// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/core/stopwatch.hpp"

#include <algorithm>

namespace equidem {

void StageTimes::add(const std::string& stage, double seconds) {
  const auto known = std::find_if(stages_.begin(), stages_.end(), [&](const auto& s) { return s.first == stage; });
  if (known == stages_.end()) {
    stages_.emplace_back(stage, seconds);
  } else {
    known->second += seconds;
  }
}

void StageTimes::add(const StageTimes& others) {
  for (const auto& [stage, seconds] : others.stages_) add(stage, seconds);
}

double StageTimes::of(const std::string& stage) const {
  for (const auto& [name, seconds] : stages_) {
    if (name == stage) return seconds;
  }
  return 0;
}

double StageTimes::total() const {
  double sum = 0;
  for (const auto& [name, seconds] : stages_) sum += seconds;
  return sum;
}

}  // namespace equidem
