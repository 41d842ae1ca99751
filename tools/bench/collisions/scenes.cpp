// SPDX-License-Identifier: GPL-3.0-or-later
#include "scenes.hpp"

#include <cmath>
#include <numbers>

#include "equidem/core/random.hpp"

namespace equidem::bench {
namespace {

constexpr double gravity = 9.8;

Grain body(Vec2 position, double radius, Body kind, Vec2 velocity = {}) {
  Grain grain;
  grain.position = position;
  grain.radius = radius;
  grain.inertia = inertia_of(radius, kind == Body::sphere ? 1 : 1 / (std::numbers::pi * radius * radius), kind);
  grain.velocity = velocity;
  return grain;
}

Wall line(const char* name, Vec2 point, Vec2 normal) {
  Wall wall;
  wall.name = name;
  wall.point = point;
  wall.normal = normal;
  return wall;
}

GrainScene scene_of(const PairProperties& pair, Vec2 pull = {}) {
  GrainScene scene;
  scene.pairs = {pair};
  scene.gravity = pull;
  return scene;
}

}  // namespace

GrainScene gas(int discs, double fraction, const PairProperties& pair) {
  GrainScene scene = scene_of(pair);
  const double spacing = 0.5 * std::sqrt(std::numbers::pi / fraction);
  const int columns = static_cast<int>(std::ceil(std::sqrt(static_cast<double>(discs))));
  Random random(1);
  for (int k = 0; k < discs; ++k) {
    const Vec2 place{(k % columns + 0.5) * spacing, (std::floor(k / columns) + 0.5) * spacing};
    const double way = random.uniform(0, 2 * std::numbers::pi);
    scene.grains.push_back(body(place, 0.5, Body::disc, {std::cos(way), std::sin(way)}));
  }
  const double side = columns * spacing;
  scene.walls = {line("floor", {0, 0}, {0, 1}), line("left", {0, 0}, {1, 0}), line("right", {side, 0}, {-1, 0}),
                 line("lid", {0, side}, {0, -1})};
  return scene;
}

GrainScene free_flight(int discs) {
  GrainScene scene = gas(discs, 0.03, {.dimensionless = 0.1});
  scene.walls.clear();
  scene.gravity = {0, -gravity};
  for (Grain& grain : scene.grains) grain.velocity = 0.01 * grain.velocity;
  return scene;
}

GrainScene packed_bed(int columns, int rows, const PairProperties& pair) {
  GrainScene scene = scene_of(pair, {0, -1});
  constexpr double spacing = 1 - 5e-4;  // pressed from the start
  const double rise = 0.5 * std::numbers::sqrt3 * spacing;
  for (int row = 0; row < rows; ++row) {
    for (int k = 0; k < columns; ++k) {
      const Vec2 place{(k + 0.5 + 0.5 * (row % 2)) * spacing, 0.5 * spacing + rise * row};
      scene.grains.push_back(body(place, 0.5, Body::disc));
    }
  }
  scene.walls = {line("floor", {0, 0}, {0, 1}), line("left", {0, 0}, {1, 0}),
                 line("right", {(columns + 0.5) * spacing, 0}, {-1, 0})};
  return scene;
}

}  // namespace equidem::bench
