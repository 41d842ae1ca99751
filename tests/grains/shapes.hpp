// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Small scenes with ellipses and clumps.
#pragma once

#include <algorithm>
#include <cmath>

#include "equidem/geometry/shape_contact.hpp"
#include "equidem/grains/scene/grain_shapes.hpp"

#include "grains/scenes.hpp"

namespace equidem::test {

/// Of mass 1.
inline Grain oval(Vec2 position, double a, double b, double angle = 0, Vec2 velocity = {}) {
  Grain grain = ball(position, a, velocity);
  grain.short_half_axis = b;
  grain.inertia.moment = (a * a + b * b) / 4;
  grain.angle = angle;
  return grain;
}

/// Of mass 1; the discs are added to the scene.
inline Grain lump(GrainScene& scene, std::vector<Clump::Disc> discs, Vec2 position, double angle = 0,
                  Vec2 velocity = {}) {
  scene.clumps.push_back(centred_clump(std::move(discs)));
  const Clump& clump = scene.clumps.back();
  Grain grain = ball(position, radius_of(clump), velocity);
  const Inertia inertia = inertia_of_clump(clump, 1);
  grain.inertia.moment = inertia.moment / inertia.mass;
  grain.clump = static_cast<int>(scene.clumps.size()) - 1;
  grain.angle = angle;
  return grain;
}

/// Two discs of the radius 1 that touch.
inline std::vector<Clump::Disc> pair_of_discs() {
  return {{{-1, 0}, 1}, {{1, 0}, 1}};
}

/// Discs, ellipses and clumps in turn, thrown about.
inline std::vector<Grain> mixed_grains(GrainScene& scene, int columns, int rows, std::uint64_t seed) {
  Random random(seed);
  std::vector<Grain> grains;
  for (int i = 0; i < columns; ++i) {
    for (int j = 0; j < rows; ++j) {
      const double size = random.uniform(0.3, 0.49), angle = random.uniform(-4, 4);
      const Vec2 place{i + 0.5, j + 0.5}, velocity{random.uniform(-1, 1), random.uniform(-1, 1)};
      switch ((i + j) % 4) {
        case 0:
          grains.push_back(ball(place, size, velocity));
          break;
        case 1:
          grains.push_back(oval(place, size, size * random.uniform(0.3, 0.9), angle, velocity));
          break;
        case 2:
          grains.push_back(lump(scene, {{{0, 0}, 0.5 * size}, {{0.8 * size, 0}, 0.4 * size}}, place, angle, velocity));
          break;
        default:
          grains.push_back(lump(scene, {{{0, 0}, size / 2}, {{size / 2, 0}, size / 3}, {{0, size / 2}, size / 4}},
                                place, angle, velocity));
      }
      grains.back().spin = random.uniform(-1, 1);
    }
  }
  return grains;
}

inline GrainScene mixed_box(NormalLaw law, int columns, int rows, std::uint64_t seed) {
  GrainScene scene = busy_box(law, columns, rows, seed);
  scene.grains = mixed_grains(scene, columns, rows, seed);
  return scene;
}

/// Ellipses of equal area and aspects from 1 to 30, apart from one another, that fly and spin in a box.
inline GrainScene flying_needles(int count, std::uint64_t seed) {
  const double side = 12;
  GrainScene scene = scene_of({},
                              {line("floor", {0, 0}, {0, 1}), line("left", {0, 0}, {1, 0}),
                               line("right", {side, 0}, {-1, 0}), line("lid", {0, side}, {0, -1})},
                              {.stiffness = 1e4, .restitution = 0.8, .friction = 0.3, .tangential_ratio = 0.5});
  Random random(seed);
  while (static_cast<int>(scene.grains.size()) < count) {
    const double root = std::pow(30, random.uniform(0, 0.5)), a = 0.5 * root, b = 0.5 / root;
    // one after the other: the order in which arguments are evaluated depends on the compiler
    const Vec2 velocity{random.uniform(-1, 1), random.uniform(-1, 1)};
    const double angle = random.uniform(-3, 3);
    const Vec2 position{random.uniform(a, side - a), random.uniform(a, side - a)};
    Grain grain = oval(position, a, b, angle, velocity);
    grain.spin = random.uniform(-3, 3);
    const bool free = std::all_of(scene.grains.begin(), scene.grains.end(), [&](const Grain& other) {
      const Vec2 branch = other.position - grain.position;
      return contact_of_ellipses({a, b, axis_at(grain.angle)},
                                 {other.radius, other.short_half_axis, axis_at(other.angle)}, branch)
                 .gap > 0.01;
    });
    if (free) scene.grains.push_back(grain);
  }
  return scene;
}

}  // namespace equidem::test
