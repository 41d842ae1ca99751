// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/motion/wall.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

/// A vector shorter than this has no direction: its square is no number.
constexpr double shortest = 1e-150;

/// Also refuses what is no number.
bool is_unit(const Vec2& direction) {
  return std::abs(dot(direction, direction) - 1) <= 1e-12;
}

[[noreturn]] void refuse(const Wall& wall, const std::string& what, std::string why, std::string remedy) {
  bad_input(fmt::format("wall '{}' {}", wall.name, what), std::move(why), std::move(remedy));
}

void check_place(const Wall& wall, const char* does, const Vec2& place) {
  if (std::isfinite(place.x) && std::isfinite(place.y)) return;
  refuse(wall, fmt::format("{} at ({}, {}) m", does, place.x, place.y), "it stands nowhere", "Give finite numbers");
}

double lowest_value(const Schedule& schedule) {
  switch (schedule.kind) {
    case Schedule::Kind::constant:
    case Schedule::Kind::ramp:
      return schedule.value;
    case Schedule::Kind::sine:
      return -std::abs(schedule.value);
    case Schedule::Kind::cycles:
      return std::min(0.0, schedule.value);
    case Schedule::Kind::table:
      break;
  }
  return *std::min_element(schedule.values.begin(), schedule.values.end());
}

}  // namespace

void check(const Servo& servo, const std::string& name) {
  const std::string owner = fmt::format(" of the servo of wall '{}'", name);
  check(servo.wanted);
  if (const double lowest = lowest_value(servo.wanted); !(lowest >= 0)) {
    bad_input(fmt::format("the servo of wall '{}' wants {:.6g}", name, lowest),
              "a wall pushes bodies and does not pull them", "Give a force or stress of 0 or more at all times");
  }
  if (!is_unit(servo.direction)) {
    bad_input(fmt::format("the servo of wall '{}' pushes along ({}, {})", name, servo.direction.x, servo.direction.y),
              "that is no unit vector", "Divide it by its length");
  }
  if (servo.max_speed) check_positive(*servo.max_speed, "max_speed" + owner, "m/s");
  check_range(Range::above_zero_to(1), servo.relaxation, "relaxation" + owner);
  if (servo.is_stress) check_range(Range::not_negative(), servo.length, "length" + owner, "m");
}

double ControlState::asked_rate(double relaxation, double spring, double dashpot) const {
  const double going_on = spring * mean_rate + dashpot * rate;
  return (relaxation * (wanted - present) + going_on) / (spring + dashpot);
}

void ControlState::count(bool acts, double share) {
  largest_wanted = std::max(largest_wanted, std::abs(wanted));
  const double beyond = wanted < 0 ? wanted - present : present - wanted;
  if (acts && !reached) {
    if (side == 0) side = beyond < 0 ? -1 : 1;
    if (std::abs(beyond) <= 0.01 * std::abs(wanted) || beyond * side < 0) reached = arrived = true;
  }
  if (!reached || largest_wanted == 0) return;
  const double error = beyond / largest_wanted;
  excess = steps > 0 && share < 1 ? excess + share * (error - excess) : error;
  overshoot = std::max(overshoot, excess);
  peak = std::max(peak, error);
  errors += std::abs(error);
  ++steps;
}

void ControlState::count_anew() {
  largest_wanted = excess = overshoot = peak = errors = 0;
  steps = 0;
  reached = false;
  side = 0;
}

ControlReport ControlState::report() const {
  return {.reached = reached,
          .wanted = wanted,
          .present = present,
          .overshoot = largest_wanted > 0 ? overshoot : NAN,
          .peak = largest_wanted > 0 ? peak : NAN,
          .mean_error = steps > 0 ? errors / static_cast<double>(steps) : NAN};
}

void move_along(Wall& wall, Vec2 direction, const Schedule& displacement) {
  if (direction.x != 0) wall.move_x = scaled(displacement, direction.x);
  if (direction.y != 0) wall.move_y = scaled(displacement, direction.y);
}

std::vector<std::string> names_of(std::span<const Wall> walls) {
  std::vector<std::string> names;
  for (const Wall& wall : walls) names.push_back(wall.name);
  return names;
}

void check(const Wall& wall) {
  check_place(wall, "stands", wall.point);
  if (wall.shape == Wall::Shape::segment) {
    check_place(wall, "ends", wall.end);
    if (norm(wall.end - wall.point) < shortest) {
      refuse(wall, fmt::format("begins and ends at ({}, {}) m", wall.end.x, wall.end.y),
             "a segment without length has no sides", "Move one of its ends");
    }
  } else if (!is_unit(wall.normal)) {
    refuse(wall, fmt::format("has the normal ({}, {}), which is no unit vector", wall.normal.x, wall.normal.y),
           "distances are measured with it", "Divide it by its length");
  }
  check(wall.move_x);
  check(wall.move_y);
  if (wall.servo) check(*wall.servo, wall.name);
}

namespace {

/// From a point of the wall to the centre.
WallContact contact_with_end(int end, const Vec2& branch, const Vec2& own_normal) {
  const double distance = norm(branch);
  return distance < shortest ? WallContact{0, own_normal, end} : WallContact{distance, branch / distance, end};
}

/// Next to an end, of the length of a segment.
constexpr double next_to = 1e-9;

bool segment_is_passed(const Wall& wall, const Vec2& before, const Vec2& after) {
  const Vec2 along = wall.end - wall.point;
  const auto on_own_side = [&](const Vec2& p) { return cross(along, p - wall.point) >= 0; };
  if (on_own_side(before) == on_own_side(after)) return false;
  const Vec2 way = after - before;
  const double point_left = cross(way, wall.point - before);
  const double end_left = cross(way, wall.end - before);
  return (point_left <= 0 && end_left >= 0) || (point_left >= 0 && end_left <= 0);
}

}  // namespace

WallContact nearest_of_segment(const Wall& wall, const Vec2& centre) {
  const Vec2 along = wall.end - wall.point;
  const Vec2 branch = centre - wall.point;
  const double length = norm(along);
  const Vec2 own_normal = perpendicular(along) / length;
  const double foot = dot(branch, along);
  if (foot < 0) return contact_with_end(1, branch, own_normal);
  if (foot > length * length) return contact_with_end(2, centre - wall.end, own_normal);
  const double share = foot / (length * length);
  const int end = share <= next_to ? 1 : share >= 1 - next_to ? 2 : 0;
  // By its height and not from the foot: next to the wall the difference would be all rounding.
  const double height = cross(along, branch) / length;
  return height < 0 ? WallContact{-height, -own_normal, end} : WallContact{height, own_normal, end};
}

bool passes_through(const Wall& wall, const Vec2& before, const Vec2& after) {
  if (wall.shape == Wall::Shape::segment) return segment_is_passed(wall, before, after);
  return (dot(wall.normal, before - wall.point) >= 0) != (dot(wall.normal, after - wall.point) >= 0);
}

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
