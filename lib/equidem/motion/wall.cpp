// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/motion/wall.hpp"

#include <algorithm>
#include <cmath>
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

}  // namespace equidem
