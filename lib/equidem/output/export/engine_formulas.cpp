// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/output/export/engine_formulas.hpp"

#include <cmath>
#include <numbers>

#include "equidem/core/text.hpp"
#include "equidem/core/vector.hpp"

namespace equidem {

std::string exact(double value) {
  return fmt::format("{}", value);
}

std::string formula_of(const Schedule& schedule, const std::string& time) {
  const auto negative = [](double value) { return value < 0 ? fmt::format("({})", value) : exact(value); };
  const auto since = [&](double start) { return fmt::format("({0}-{1}+abs({0}-{1}))/2", time, negative(start)); };
  // The time between two instants, from 0 to their distance.
  const auto between = [&](double start, double end) {
    return fmt::format("(abs({0}-{1})-abs({0}-{2})+{3})/2", time, negative(start), negative(end), exact(end - start));
  };
  const auto slope_of = [&](std::size_t k) {
    return (schedule.values[k + 1] - schedule.values[k]) / (schedule.times[k + 1] - schedule.times[k]);
  };
  std::string sum;
  switch (schedule.kind) {
    case Schedule::Kind::constant:
      sum = exact(schedule.value);
      break;
    case Schedule::Kind::ramp:
      sum =
          fmt::format("{}*(1-cos({}*({})))", negative(0.5 * schedule.value),
                      exact(std::numbers::pi / (schedule.end - schedule.start)), between(schedule.start, schedule.end));
      break;
    case Schedule::Kind::sine:
      sum = fmt::format("{}*sin({}*({}))", negative(schedule.value), exact(2 * std::numbers::pi * schedule.frequency),
                        since(schedule.start));
      break;
    case Schedule::Kind::cycles:
      sum = fmt::format("{}*(1-cos({}*({})))", negative(schedule.value),
                        exact(2 * std::numbers::pi * schedule.frequency), between(schedule.start, schedule.end));
      break;
    case Schedule::Kind::table:
      sum = exact(schedule.values.front());
      for (std::size_t k = 0; k + 1 < schedule.times.size(); ++k) {
        if (slope_of(k) == 0) continue;
        sum += fmt::format("+{}*{}", negative(slope_of(k)), between(schedule.times[k], schedule.times[k + 1]));
      }
      break;
  }
  return sum;
}

}  // namespace equidem
