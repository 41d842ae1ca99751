// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/grains/scene/shaking.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <vector>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

Schedule table_of(std::span<const double> times, std::span<const double> values, double start) {
  assert(times.size() == values.size());
  if (times.size() < 2)
    bad_input(fmt::format("a recorded motion has {}", counted(static_cast<long long>(times.size()), "point")),
              "it takes two to move", "Give the whole record");
  Schedule table{.kind = Schedule::Kind::smooth_table};
  for (const double time : times) table.times.push_back(start + (time - times.front()));
  table.values.assign(values.begin(), values.end());
  table.rates.assign(values.size(), 0.0);
  check(table);
  return table;
}

/// Displacement and velocity at the points, from the accelerations there.
void integrate(Schedule& table, std::span<const double> a) {
  double v = 0, x = 0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    if (k > 0) {
      const double h = table.times[k] - table.times[k - 1];
      x += h * (v + h * (a[k - 1] / 3 + a[k] / 6));
      v += 0.5 * h * (a[k - 1] + a[k]);
    }
    table.values[k] = x;
    table.rates[k] = v;
  }
}

/// \param a accelerations at the points, linear between them
void find_extremes(std::span<const double> a, GroundMotion& motion) {
  const Schedule& table = motion.displacement;
  const auto raise = [](double& peak, double value) { peak = std::max(peak, std::abs(value)); };
  for (std::size_t k = 0; k < a.size(); ++k) {
    raise(motion.peak_acceleration, a[k]);
    raise(motion.peak_velocity, table.rates[k]);
    raise(motion.peak_displacement, table.values[k]);
    if (k == 0 || !(a[k - 1] * a[k] < 0)) continue;
    const double until = (table.times[k] - table.times[k - 1]) * a[k - 1] / (a[k - 1] - a[k]);
    raise(motion.peak_velocity, table.rates[k - 1] + 0.5 * until * a[k - 1]);
  }
  motion.final_displacement = table.values.back();
}

/// Slopes of the spline with the slope 0 at both ends: its second derivative is continuous.
void find_slopes(Schedule& table) {
  const auto& t = table.times;
  const auto& x = table.values;
  const std::size_t n = t.size();
  if (n < 3) return;
  std::vector<double> upper(n, 0.0), right(n, 0.0);  // of the eliminated rows
  for (std::size_t k = 1; k + 1 < n; ++k) {
    const double before = t[k] - t[k - 1], after = t[k + 1] - t[k];
    const double wanted = 3 * (after * (x[k] - x[k - 1]) / before + before * (x[k + 1] - x[k]) / after);
    const double pivot = 2 * (before + after) - after * upper[k - 1];
    upper[k] = before / pivot;
    right[k] = (wanted - after * right[k - 1]) / pivot;
  }
  for (std::size_t k = n - 1; k-- > 1;) table.rates[k] = right[k] - upper[k] * table.rates[k + 1];
}

}  // namespace

Schedule harmonic_shaking(double acceleration, double frequency, double start, std::int64_t cycles) {
  const double omega = 2 * std::numbers::pi * frequency;
  const Schedule schedule{.kind = Schedule::Kind::cycles,
                          .value = acceleration / (omega * omega),
                          .start = start,
                          .end = start + static_cast<double>(cycles) / frequency,
                          .frequency = frequency};
  check(schedule);
  return schedule;
}

GroundMotion integrate_motion(std::span<const double> times, std::span<const double> accelerations, double start,
                              Baseline baseline) {
  GroundMotion motion{.displacement = table_of(times, accelerations, start)};
  Schedule& table = motion.displacement;
  std::vector<double> a = table.values;
  integrate(table, a);
  // What c + d t/T adds up to: velocity (c + d/2) T, displacement (c/2 + d/6) T².
  const double duration = table.times.back() - table.times.front();
  const double mean = table.rates.back() / duration, way = table.values.back() / (duration * duration);
  const bool straight = baseline == Baseline::rest;
  const double c = straight ? 6 * way - 2 * mean : mean, d = straight ? 6 * (mean - 2 * way) : 0;
  for (std::size_t k = 0; k < a.size(); ++k) a[k] -= c + d * (table.times[k] - table.times.front()) / duration;
  motion.correction = std::max(std::abs(c), std::abs(c + d));
  integrate(table, a);
  table.rates.back() = 0;  // but for rounding
  check(table);
  find_extremes(a, motion);
  return motion;
}

GroundMotion follow_motion(std::span<const double> times, std::span<const double> displacements, double start) {
  GroundMotion motion{.displacement = table_of(times, displacements, start)};
  Schedule& table = motion.displacement;
  for (double& value : table.values) value -= displacements.front();
  find_slopes(table);
  check(table);
  std::vector<double> a(table.times.size());
  for (std::size_t k = 0; k < a.size(); ++k) {
    const std::size_t from = k + 1 < a.size() ? k : k - 1;
    const double h = table.times[from + 1] - table.times[from];
    const double mean = (table.values[from + 1] - table.values[from]) / h;
    const double first = table.rates[from], last = table.rates[from + 1];
    a[k] = (k == from ? 6 * mean - 4 * first - 2 * last : 2 * first + 4 * last - 6 * mean) / h;
  }
  find_extremes(a, motion);
  return motion;
}

void shake(std::span<GrainWall> walls, Vec2 direction, const Schedule& displacement) {
  for (GrainWall& wall : walls) {
    if (wall.moves())
      bad_input(fmt::format("wall '{}' moves by itself", wall.name), "the box moves it too",
                "Leave out its displacement, or keep it out of the shaking");
    if (direction.x != 0) wall.move_x = scaled(displacement, direction.x);
    if (direction.y != 0) wall.move_y = scaled(displacement, direction.y);
  }
}

}  // namespace equidem
