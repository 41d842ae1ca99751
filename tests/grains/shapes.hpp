// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Small scenes with ellipses and clumps.
#pragma once

#include "equidem/grains/clump.hpp"

#include "grains/scenes.hpp"

namespace equidem::test {

/// Laws and schemes that ellipses and clumps can have.
inline const std::vector<Stepping> force_steppings(all_steppings.begin(), all_steppings.begin() + 6);

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

}  // namespace equidem::test
