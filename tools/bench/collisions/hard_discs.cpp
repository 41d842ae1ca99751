// SPDX-License-Identifier: GPL-3.0-or-later
#include "hard_discs.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "equidem/core/random.hpp"

#include "bench.hpp"

namespace equidem::bench {
namespace {

constexpr double never = std::numeric_limits<double>::infinity();

/// Time until the distance of two discs is `reach`. \param r, v place and velocity of one seen from the other
double time_to_impact(Vec2 r, Vec2 v, double reach) {
  const double rate = dot(r, v);
  if (rate >= 0) return never;
  const double gap = dot(r, r) - reach * reach, root = rate * rate - dot(v, v) * gap;
  return root < 0 ? never : std::max(0.0, gap / (std::sqrt(root) - rate));
}

struct Impact {
  double wait;  ///< s from now
  std::size_t i = 0, j = 0;
  const Wall* wall = nullptr;  ///< that i meets; null: i meets j, or nothing if they are the same
};

/// The first impact before `end`, or none at `end`.
Impact next_impact(const GrainScene& scene, const std::vector<Vec2>& x, const std::vector<Vec2>& v, double end) {
  Impact next{end};
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double own = scene.grains[i].radius;
    for (const Wall& wall : scene.walls) {
      const double closing = -dot(v[i], wall.normal), gap = dot(x[i] - wall.point, wall.normal) - own;
      const double wait = closing > 0 ? std::max(0.0, gap / closing) : never;
      if (wait < next.wait) next = {wait, i, i, &wall};
    }
    for (std::size_t j = i + 1; j < x.size(); ++j) {
      const double wait = time_to_impact(x[j] - x[i], v[j] - v[i], own + scene.grains[j].radius);
      if (wait < next.wait) next = {wait, i, j};
    }
  }
  return next;
}

}  // namespace

Grain disc_at(Vec2 position, Vec2 velocity) {
  const double density = 1 / (std::numbers::pi * radius * radius);
  return {
      .position = position, .radius = radius, .inertia = inertia_of(radius, density, Body::disc), .velocity = velocity};
}

GrainScene gas(int discs, double fraction, const PairProperties& pair) {
  const double spacing = radius * std::sqrt(std::numbers::pi / fraction);
  const int columns = static_cast<int>(std::ceil(std::sqrt(static_cast<double>(discs))));
  GrainScene scene;
  scene.pairs = {pair};
  Random random(1);
  for (int k = 0; k < discs; ++k) {
    const double angle = random.uniform(0, 2 * std::numbers::pi);
    scene.grains.push_back(disc_at({(k % columns + 0.5) * spacing, (std::floor(k / columns) + 0.5) * spacing},
                                   {std::cos(angle), std::sin(angle)}));
  }
  scene.walls = box_walls(columns * spacing, columns * spacing);
  return scene;
}

HardDiscs hard_discs_at(const GrainScene& scene, double time) {
  std::vector<Vec2> x, v;
  for (const Grain& grain : scene.grains) {
    x.push_back(grain.position);
    v.push_back(grain.velocity);
  }
  const double e = scene.pairs[0].restitution;
  for (int impacts = 0;; ++impacts) {
    const Impact next = next_impact(scene, x, v, time);
    for (std::size_t i = 0; i < x.size(); ++i) x[i] += next.wait * v[i];
    time -= next.wait;
    if (next.wall) {
      v[next.i] -= ((1 + e) * dot(v[next.i], next.wall->normal)) * next.wall->normal;
    } else if (next.i != next.j) {
      const Vec2 branch = x[next.j] - x[next.i], normal = branch / norm(branch);
      const Vec2 change = (0.5 * (1 + e) * dot(v[next.j] - v[next.i], normal)) * normal;
      v[next.i] += change;
      v[next.j] -= change;
    } else {
      return {x, impacts};
    }
  }
}

}  // namespace equidem::bench
