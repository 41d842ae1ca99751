// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/grains/scene/shaking.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

std::int64_t count_cycles(const ShakingOptions& options, double run_duration) {
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

void set_motion(const ShakingOptions& options, double run_duration, Shaking& shaking) {
  if (!(options.start < run_duration))
    bad_input_at("start", fmt::format("the box begins to shake at {} s", options.start),
                 fmt::format("the run ends at {} s", run_duration), "Start earlier, or run longer");
  const double a = options.acceleration, omega = 2 * std::numbers::pi * options.frequency;
  shaking.frequency = options.frequency;
  shaking.cycles = count_cycles(options, run_duration);
  try {
    shaking.displacement = harmonic_shaking(a, options.frequency, options.start, shaking.cycles);
  } catch (const Error& error) {
    throw error.at("frequency");
  }
  shaking.peak_acceleration = a;
  shaking.peak_velocity = a / omega;
  shaking.peak_displacement = 2 * a / (omega * omega);
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

Shaking shaking_of(const ShakingOptions& options, double run_duration) {
  const double length = norm(options.direction);
  if (!(length > 0))
    bad_input_at("direction", "the direction of the shaking is zero", "it says where the box moves",
                 "Give a direction, such as [1.0, 0.0]");
  Shaking shaking{.direction = options.direction / length, .displacement = {}};
  set_motion(options, run_duration, shaking);
  constexpr double fastest = 3e8;  // light
  if (!(shaking.peak_velocity < fastest))
    bad_input(fmt::format("the box would move with {:.3g} m/s", shaking.peak_velocity),
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
