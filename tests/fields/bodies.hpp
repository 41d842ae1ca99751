// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Bodies of every shape, and what is inside them.
#pragma once

#include <cmath>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "equidem/core/random.hpp"
#include "equidem/grains/scene/grain_scene.hpp"

namespace equidem::test {

struct Bodies {
  std::vector<Grain> grains;
  std::vector<Clump> clumps;
};

inline Grain disc(Vec2 position, double radius, Vec2 velocity = {}) {
  Grain grain;
  grain.position = position;
  grain.radius = radius;
  grain.velocity = velocity;
  grain.inertia = {radius * radius, 0.5 * radius * radius * radius * radius};
  return grain;
}

inline Wall line(std::string name, Vec2 point, Vec2 normal) {
  Wall wall;
  wall.name = std::move(name);
  wall.point = point;
  wall.normal = normal;
  return wall;
}

/// In the unit square; they may overlap.
inline Bodies scattered(GrainShape shape, int count, std::uint64_t seed) {
  Random random(seed);
  Bodies bodies;
  if (shape == GrainShape::clump)
    bodies.clumps = {{{{{-0.02, 0}, 0.025}, {{0.02, 0}, 0.02}}},
                     {{{{-0.02, -0.01}, 0.02}, {{0.02, -0.01}, 0.02}, {{0, 0.02}, 0.02}}}};
  for (int k = 0; k < count; ++k) {
    Grain grain = disc({random.uniform(), random.uniform()}, random.uniform(0.02, 0.05));
    grain.angle = random.uniform(-4, 4);
    if (shape == GrainShape::ellipse) grain.short_half_axis = grain.radius * random.uniform(0.2, 0.9);
    if (shape == GrainShape::clump) {
      grain.clump = k % 2;
      grain.radius = 0.05;
    }
    bodies.grains.push_back(grain);
  }
  return bodies;
}

/// Whether a place lies in a body.
inline bool holds(const Grain& grain, std::span<const Clump> clumps, Vec2 place) {
  const Vec2 way = place - grain.position, axis{std::cos(grain.angle), std::sin(grain.angle)};
  const Vec2 own{dot(way, axis), cross(axis, way)};
  if (grain.shape() == GrainShape::clump) {
    for (const Clump::Disc& disc : clumps[static_cast<std::size_t>(grain.clump)].discs)
      if (norm(own - disc.offset) < disc.radius) return true;
    return false;
  }
  const double b = grain.shape() == GrainShape::ellipse ? grain.short_half_axis : grain.radius;
  return norm({own.x / grain.radius, own.y / b}) < 1;
}

}  // namespace equidem::test
