// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// [wall.servo]: a wall that follows a force or a stress.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "equidem/casefile/engine/bind.hpp"
#include "equidem/motion/wall.hpp"

namespace equidem::casefile {

/// [wall.servo].
struct ServoTable {
  Servo servo;                                  ///< `between` is `from` and `to`
  std::optional<double> force;                  ///< N
  std::optional<double> stress;                 ///< Pa
  std::optional<Vec2> direction;                ///< none: the normal of a line
  std::optional<double> length;                 ///< m
  std::optional<std::string> from, to, mirror;  ///< names of walls
  std::optional<std::string> schedule;          ///< its name
};

std::vector<Key<ServoTable>> servo_keys();

/// The servo of a wall, if its table has one.
/// \param table checked, of the wall
/// \param path of the table, for errors: "wall"
/// \throws Error (bad_input) with line and key: a direction of length 0 or that is missing, a stress without a length,
///         a schedule that is not there, as check(Servo)
void read_servo(const TomlValue& table, const std::string& path, std::span<const NamedSchedule> schedules, Wall& wall);

}  // namespace equidem::casefile
