// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/grains/scene/shaking.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>
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

std::int64_t count_cycles(const HarmonicShaking& options, double run_duration) {
  if (options.cycles) {
    if (options.duration)
      bad_input_at("duration", "duration does not apply", "cycles says how long the box shakes", "Remove it");
    return *options.cycles;
  }
  const double periods = options.frequency * options.duration.value_or(run_duration - options.start);
  const double whole = std::round(periods);
  if (options.duration && (whole < 1 || std::abs(periods - whole) > 1e-6 * whole))
    bad_input_at("duration",
                 fmt::format("{} s are {:.6g} cycles of {} Hz", *options.duration, periods, options.frequency),
                 "only whole cycles end at rest",
                 fmt::format("Make it {:.6g} s, or give cycles", std::max(1.0, whole) / options.frequency));
  constexpr double most = 1e12;
  if (!(periods < most))
    bad_input_at("frequency", fmt::format("the box would shake {:.3g} times", periods),
                 "the run has fewer steps than that", "Lower it, or give cycles");
  // Without a duration the last cycle may reach beyond the end of the run.
  return static_cast<std::int64_t>(options.duration ? whole : std::max(1.0, std::ceil(periods - 1e-9 * whole)));
}

void set_motion(const HarmonicShaking& options, double run_duration, Shaking& shaking) {
  if (!(options.start < run_duration))
    bad_input_at("start", fmt::format("the box begins to shake at {} s", options.start),
                 fmt::format("the run ends at {} s", run_duration), "Start earlier, or run longer");
  const double a = options.acceleration, omega = 2 * std::numbers::pi * options.frequency;
  shaking.frequency = options.frequency;
  shaking.cycles = count_cycles(options, run_duration);
  try {
    shaking.motion.displacement = harmonic_shaking(a, options.frequency, options.start, shaking.cycles);
  } catch (const Error& error) {
    throw error.at("frequency");
  }
  shaking.motion.peak_acceleration = a;
  shaking.motion.peak_velocity = a / omega;
  shaking.motion.peak_displacement = 2 * a / (omega * omega);
}

void set_motion(const RecordedShaking& options, double /*run_duration*/, Shaking& shaking) {
  shaking.recorded = true;
  std::vector<double> values = options.values;
  for (double& value : values) value *= options.scale;
  try {
    shaking.motion = options.quantity == RecordedShaking::Quantity::displacement
                         ? follow_motion(options.times, values, options.start)
                         : integrate_motion(options.times, values, options.start, options.baseline);
  } catch (const Error& error) {
    throw error.at("record");
  }
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

double Shaking::start() const {
  return recorded ? motion.displacement.times.front() : motion.displacement.start;
}

double Shaking::end() const {
  return recorded ? motion.displacement.times.back() : motion.displacement.end;
}

Shaking shaking_of(const ShakingOptions& options, double run_duration) {
  const double length = norm(options.direction);
  if (!(length > 0))
    bad_input_at("direction", "the direction of the shaking is zero", "it says where the box moves",
                 "Give a direction, such as [1.0, 0.0]");
  Shaking shaking{.direction = options.direction / length, .motion = {}};
  std::visit([&](const auto& motion) { set_motion(motion, run_duration, shaking); }, options.motion);
  constexpr double fastest = 3e8;  // light
  if (!(shaking.motion.peak_velocity < fastest))
    bad_input(fmt::format("the box would move with {:.3g} m/s", shaking.motion.peak_velocity),
              fmt::format("nothing is faster than {:.0e} m/s", fastest),
              "Give a smaller acceleration, or check the units");
  return shaking;
}

void shake(std::span<Wall> walls, Vec2 direction, const Schedule& displacement) {
  for (Wall& wall : walls) {
    if (wall.moves())
      bad_input(fmt::format("wall '{}' moves by itself", wall.name), "the box moves it too",
                "Leave out its displacement, or keep it out of the shaking");
    move_along(wall, direction, displacement);
  }
}

}  // namespace equidem
