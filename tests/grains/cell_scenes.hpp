// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Bodies in periodic cells.
#pragma once

#include <utility>

#include "grains/scenes.hpp"

namespace equidem::test {

/// The bodies of a box in a cell of its size, without walls, gravity or momentum, their velocities times `speed`.
inline GrainScene in_cell_of_its_size(GrainScene scene, int columns, int rows, double speed) {
  scene.walls.clear();
  scene.gravity = {};
  scene.cell = PeriodicCell{.corner = {0, 0}, .width = 1.0 * columns, .height = 1.0 * rows};
  Vec2 momentum;
  double mass = 0;
  for (Grain& grain : scene.grains) {
    grain.velocity = speed * grain.velocity;
    momentum += grain.inertia.mass * grain.velocity;
    mass += grain.inertia.mass;
  }
  for (Grain& grain : scene.grains) grain.velocity -= momentum / mass;
  return scene;
}

/// Discs of several sizes with friction that fly about in a cell.
inline GrainScene busy_cell(NormalLaw law, int columns, int rows, std::uint64_t seed, double speed = 1) {
  return in_cell_of_its_size(busy_box(law, columns, rows, seed), columns, rows, speed);
}

inline GrainOptions verlet_options(double step = 0.005) {
  return options_of(Stepping{NormalLaw::linear_dashpot, GrainIntegrator::velocity_verlet}, step);
}

/// The least distance of two places over all images.
inline double distance_in_cell(Vec2 a, Vec2 b, const CellState& cell) {
  Vec2 apart = b - a;
  const double rows = std::nearbyint(apart.y / cell.height);
  apart -= rows * Vec2{cell.shift, cell.height};
  apart.x -= cell.width * std::nearbyint(apart.x / cell.width);
  return norm(apart);
}

}  // namespace equidem::test
