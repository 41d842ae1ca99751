// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/casefile/servo_case.hpp"

#include "equidem/casefile/engine/value.hpp"
#include "equidem/casefile/motion_case.hpp"
#include "equidem/core/text.hpp"

namespace equidem::casefile {

std::vector<Key<ServoTable>> servo_keys() {
  const std::string over_length = "it is the length on which a stress acts";
  const auto of_stress = only_with({"stress"}, over_length);
  return {
      key("force", &ServoTable::force, unit("N (discs: N/m)"), not_negative,
          or_instead({"stress"}, "a servo holds a force or a stress"), "with which the wall pushes the bodies"),
      key("stress", &ServoTable::stress, unit("Pa"), not_negative,
          "of discs, over the length of a segment, over length, or over the present length between two walls"),
      key("schedule", &ServoTable::schedule, "factor of force or stress; without one it is constant"),
      key("max_speed", &ServoTable::servo, &Servo::max_speed, optional, unit("m/s"), positive,
          "the wall is never faster, and approaches bodies with it where it touches none; left out: the speed at which "
          "the heaviest body pushes it by 5 % of the wanted force, or of the present one where that is larger"),
      key("direction", &ServoTable::direction, "in which it pushes, of any length; left out: the normal of a line"),
      key("length", &ServoTable::length, unit("m"), positive, of_stress, not_beside({"from"}, over_length),
          "on which the stress acts"),
      key("from", &ServoTable::from, of_stress, only_with({"to"}, over_length),
          "instead: a wall at one end of that length"),
      key("to", &ServoTable::to, of_stress, only_with({"from"}, over_length), "and the wall at its other end"),
      key("mirror", &ServoTable::mirror,
          "name of a wall that moves the same way in the opposite direction; force or stress is then the mean of both"),
      key("relaxation", &ServoTable::servo, &Servo::relaxation, range({.low = 0, .high = 1, .low_open = true}),
          "share of the difference that a step mends, by stiffness and dashpots of the contacts on the wall")};
}

void read_servo(const TomlValue& table, const std::string& path, std::span<const NamedSchedule> schedules, Wall& wall) {
  const TomlValue* const given = table.find("servo");
  if (given == nullptr) return;
  const std::string key = path + ".servo";
  ServoTable read;
  read_table(servo_keys(), *given, read);
  Servo servo = read.servo;
  servo.is_stress = read.stress.has_value();
  servo.wanted = scheduled(*given, key, servo.is_stress ? *read.stress : *read.force, schedules);
  if (!read.direction && wall.shape != Wall::Shape::line)
    fail_at(*given, key, fmt::format("the servo of wall '{}' has no direction", wall.name),
            "only a line has a normal to push along", "Add direction = [..., ...]");
  servo.direction = read.direction.value_or(wall.normal);
  if (norm(servo.direction) == 0)
    fail_at(*given->find("direction"), key + ".direction", "the direction is zero", "it says where the wall pushes",
            "Give a direction, such as [0.0, -1.0]");
  servo.direction = servo.direction / norm(servo.direction);
  servo.length = read.length.value_or(0);
  servo.mirror = read.mirror.value_or("");
  servo.between = {read.from.value_or(""), read.to.value_or("")};
  if (servo.is_stress && servo.length == 0 && !read.from) {
    if (wall.shape != Wall::Shape::segment)
      fail_at(*given, key, fmt::format("the stress of wall '{}' has no length to act on", wall.name),
              "a line is endless", "Give length, or the walls from and to which it is measured");
    servo.length = norm(wall.end - wall.point);
  }
  servo.place = fmt::format("{}: {}", given->where(), key);
  with_place(servo.place, [&] { check(servo, wall.name); });
  wall.servo = servo;
}

}  // namespace equidem::casefile
