// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/motion/servo.hpp"

#include <algorithm>
#include <cmath>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

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

[[noreturn]] void refuse_servo(const std::string& wall, const std::string& what, const std::string& why,
                               const std::string& remedy) {
  bad_input(fmt::format("the servo of wall '{}' {}", wall, what), why, remedy);
}

}  // namespace

void check(const Servo& servo, const std::string& name) {
  check(servo.wanted);
  if (const double lowest = lowest_value(servo.wanted); !(lowest >= 0)) {
    refuse_servo(name, fmt::format("wants {:.6g}", lowest), "a wall pushes bodies and does not pull them",
                 "Give a force or stress of 0 or more at all times");
  }
  if (!(std::abs(norm(servo.direction) - 1) <= 1e-12)) {
    refuse_servo(name, fmt::format("pushes along ({}, {})", servo.direction.x, servo.direction.y),
                 "that is no unit vector", "Divide it by its length");
  }
  const std::string owner = fmt::format(" of the servo of wall '{}'", name);
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

}  // namespace equidem
