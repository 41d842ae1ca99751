// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <numeric>
#include <tuple>

#include "equidem/grains/grain_system.hpp"

namespace equidem {
namespace {

auto place(const Grain& grain) {
  return std::tuple(grain.position.x, grain.position.y, grain.radius, grain.velocity.x, grain.velocity.y, grain.spin,
                    grain.inertia.mass, grain.inertia.moment, grain.kind, grain.angle);
}

auto place(const GrainWall& wall) {
  return std::tuple(static_cast<int>(wall.shape), wall.point.x, wall.point.y, wall.normal.x, wall.normal.y, wall.end.x,
                    wall.end.y, wall.radius, wall.from, wall.to, wall.kind);
}

template <class Item>
std::vector<std::size_t> sorted_by_place(const std::vector<Item>& items) {
  std::vector<std::size_t> order(items.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return place(items[a]) < place(items[b]); });
  return order;
}

std::vector<std::int32_t> inverse(const std::vector<std::size_t>& order) {
  std::vector<std::int32_t> places(order.size());
  for (std::size_t k = 0; k < order.size(); ++k) places[order[k]] = static_cast<std::int32_t>(k);
  return places;
}

}  // namespace

void order_by_place(GrainSystem& system, const GrainScene& scene) {
  system.grain_of = sorted_by_place(scene.grains);
  system.wall_of = sorted_by_place(scene.walls);
  system.place_of_grain = inverse(system.grain_of);
  system.place_of_wall = inverse(system.wall_of);
  system.scene = scene;
  for (std::size_t k = 0; k < scene.grains.size(); ++k) {
    const Grain& grain = scene.grains[system.grain_of[k]];
    system.scene.grains[k] = grain;
    system.bodies.push_back({grain.radius, 1 / grain.inertia.mass, 1 / grain.inertia.moment, grain.kind});
    system.motions.push_back({grain.position, grain.velocity, grain.spin, grain.angle});
  }
  for (std::size_t k = 0; k < scene.walls.size(); ++k) system.scene.walls[k] = scene.walls[system.wall_of[k]];
  system.pushes.resize(scene.grains.size());
  system.walls.resize(scene.walls.size());
}

}  // namespace equidem
