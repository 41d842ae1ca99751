// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/motion/wall.hpp"

#include <cmath>
#include <utility>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

/// A vector shorter than this has no direction: its square is no number.
constexpr double shortest = 1e-150;

bool is_finite(const Vec2& p) {
  return std::isfinite(p.x) && std::isfinite(p.y);
}

[[noreturn]] void refuse(const Wall& wall, const std::string& what, std::string why, std::string remedy) {
  bad_input(fmt::format("wall '{}' {}", wall.name, what), std::move(why), std::move(remedy));
}

void check_line(const Wall& wall) {
  // Written so that it also refuses what is no number.
  if (std::abs(dot(wall.normal, wall.normal) - 1) <= 1e-12) return;
  refuse(wall, fmt::format("has the normal ({}, {}), which is no unit vector", wall.normal.x, wall.normal.y),
         "distances are measured with it", "Divide it by its length");
}

void check_segment(const Wall& wall) {
  if (!is_finite(wall.end)) {
    refuse(wall, fmt::format("ends at ({}, {}) m", wall.end.x, wall.end.y), "it stands nowhere", "Give finite numbers");
  }
  if (norm(wall.end - wall.point) >= shortest) return;
  refuse(wall, fmt::format("begins and ends at ({}, {}) m", wall.end.x, wall.end.y),
         "a segment without length has no sides", "Move one of its ends");
}

}  // namespace

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
  if (!is_finite(wall.point)) {
    refuse(wall, fmt::format("stands at ({}, {}) m", wall.point.x, wall.point.y), "it stands nowhere",
           "Give finite numbers");
  }
  switch (wall.shape) {
    case Wall::Shape::line:
      check_line(wall);
      break;
    case Wall::Shape::segment:
      check_segment(wall);
      break;
  }
  check(wall.move_x);
  check(wall.move_y);
  if (wall.servo) check(*wall.servo, wall.name);
}

}  // namespace equidem
