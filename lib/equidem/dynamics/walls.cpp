// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/dynamics/walls.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

void check_alone(const Wall& wall, const Assembly& assembly) {
  if (assembly.periodic()) {
    bad_input(fmt::format("wall '{}' stands in a periodic assembly", wall.name),
              "every disc has images on both sides of any wall", "Remove the wall, or set periodic = false");
  }
  if (wall.shape != Wall::Shape::line) {
    bad_input(fmt::format("wall '{}' is a segment or an arc", wall.name), "bonded discs meet straight walls alone",
              "Give it the shape of a line");
  }
  if (wall.servo) {
    bad_input(fmt::format("wall '{}' has a servo", wall.name), "walls of bonded discs move by schedules alone",
              "Give it a displacement, or load the discs");
  }
  check(wall);
  if (!(wall.kN > 0) || !std::isfinite(wall.kN)) {
    bad_input(fmt::format("wall '{}' has kN = {} Pa", wall.name, wall.kN), "its spring must be > 0 and finite",
              "Give a positive one");
  }
}

/// Times at which a displacement turns or ends.
std::vector<double> turning_points(const Schedule& displacement) {
  switch (displacement.kind) {
    case Schedule::Kind::constant:
      return {};
    case Schedule::Kind::ramp:
      return {displacement.end};
    case Schedule::Kind::sine:
      return {displacement.start + 0.25 / displacement.frequency, displacement.start + 0.75 / displacement.frequency};
    case Schedule::Kind::table:
      return displacement.times;
    case Schedule::Kind::cycles:
      return {displacement.start + 0.5 / displacement.frequency, displacement.end};
  }
  return {};
}

/// Lines that are parallel to a millionth meet far outside.
bool face_each_other(const Wall& a, const Wall& b) {
  return dot(a.normal, b.normal) < 0 && std::abs(cross(a.normal, b.normal)) < 1e-6;
}

void check_room(const Wall& a, const Wall& b) {
  std::vector<double> times{0};
  for (const Wall* wall : {&a, &b})
    for (const Schedule* schedule : {&wall->move_x, &wall->move_y})
      for (const double time : turning_points(*schedule)) times.push_back(std::max(time, 0.0));
  for (const double time : times) {
    const double room =
        dot(a.normal, b.point - a.point) - a.displacement_along_normal(time) - b.displacement_along_normal(time);
    if (room > 0) continue;
    bad_input(
        fmt::format("walls '{}' and '{}' cross{}", a.name, b.name, time > 0 ? fmt::format(" at {:.6g} s", time) : ""),
        fmt::format("they face each other with {:.6g} m between them", room),
        time > 0 ? "Move them less or further apart" : "Move them apart, or turn their normals to the discs");
  }
}

void check_discs(const Wall& wall, const Assembly& assembly) {
  const double start = wall.displacement_along_normal(0);
  for (std::size_t disc = 0; disc < assembly.size(); ++disc) {
    const double height = dot(wall.normal, assembly.centres[disc] - wall.point) - start;
    if (height > 0) continue;
    bad_input(fmt::format("the centre of disc {} lies {:.6g} m behind wall '{}'", disc, -height, wall.name),
              "all discs are in front of a wall, where its normal points", "Turn the normal, or move the wall");
  }
}

}  // namespace

std::vector<DiscAtWall> wall_contacts(const Scene& scene, const std::vector<DiscMotion>& motions, double time) {
  std::vector<DiscAtWall> contacts;
  for (std::size_t w = 0; w < scene.walls.size(); ++w) {
    const Wall& wall = scene.walls[w];
    const double moved = wall.displacement_along_normal(time);
    for (std::size_t d = 0; d < motions.size(); ++d) {
      const Vec2 centre = scene.assembly.centres[d] + motions[d].u;
      const double gap = dot(wall.normal, centre - wall.point) - moved - scene.assembly.radii[d];
      if (!(gap >= 0)) contacts.push_back({.wall = w, .disc = d, .gap = gap});
    }
  }
  return contacts;
}

WallPushes wall_pushes(const Scene& scene, const std::vector<DiscMotion>& motions, double time) {
  WallPushes result;
  if (!scene.walls.empty()) result.forces.resize(motions.size());
  for (const auto& [w, disc, gap] : wall_contacts(scene, motions, time)) {
    const Wall& wall = scene.walls[w];
    result.forces[disc] -= wall.kN * gap * wall.normal;
    result.energy += 0.5 * wall.kN * gap * gap;
  }
  return result;
}

void check_wall(std::span<const Wall> walls, std::size_t k, const Assembly& assembly) {
  check_alone(walls[k], assembly);
  for (const Wall& other : walls)
    if (face_each_other(walls[k], other)) check_room(walls[k], other);
  check_discs(walls[k], assembly);
}

}  // namespace equidem
