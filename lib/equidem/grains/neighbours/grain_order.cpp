// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <numeric>
#include <tuple>

#include "equidem/grains/grain_system.hpp"
#include "equidem/grains/neighbours/part_pairs.hpp"

namespace equidem {
namespace {

auto place(const Grain& grain) {
  return std::tuple(grain.position.x, grain.position.y, grain.radius, grain.velocity.x, grain.velocity.y, grain.spin,
                    grain.inertia.mass, grain.inertia.moment, grain.kind, grain.angle, grain.short_half_axis);
}

auto place(const Wall& wall) {
  return std::tuple(static_cast<int>(wall.shape), wall.point.x, wall.point.y, wall.normal.x, wall.normal.y, wall.end.x,
                    wall.end.y, wall.kind);
}

/// Clumps in one place differ by their discs, not by the caller's number of them.
bool has_lesser_discs(const Grain& a, const Grain& b, const std::vector<Clump>& clumps) {
  if (a.clump < 0 || b.clump < 0) return a.clump < 0 && b.clump >= 0;
  const auto less = [](const GrainPart& p, const GrainPart& q) {
    return std::tuple(p.offset.x, p.offset.y, p.a) < std::tuple(q.offset.x, q.offset.y, q.a);
  };
  const std::vector<GrainPart> of_a = parts_of(a, clumps), of_b = parts_of(b, clumps);
  return std::lexicographical_compare(of_a.begin(), of_a.end(), of_b.begin(), of_b.end(), less);
}

template <class Item, class Tie>
std::vector<std::size_t> sorted_by_place(const std::vector<Item>& items, const Tie& tie) {
  std::vector<std::size_t> order(items.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    const auto of_a = place(items[a]), of_b = place(items[b]);
    return of_a == of_b ? tie(items[a], items[b]) : of_a < of_b;
  });
  return order;
}

std::vector<std::int32_t> inverse(const std::vector<std::size_t>& order) {
  std::vector<std::int32_t> places(order.size());
  for (std::size_t k = 0; k < order.size(); ++k) places[order[k]] = static_cast<std::int32_t>(k);
  return places;
}

}  // namespace

void order_by_place(GrainSystem& system, const GrainScene& scene, const std::vector<std::size_t>& order) {
  const auto lesser = [&](const Grain& a, const Grain& b) { return has_lesser_discs(a, b, scene.clumps); };
  system.bodies.grain_of = order.empty() ? sorted_by_place(scene.grains, lesser) : order;
  system.walls.wall_of = sorted_by_place(scene.walls, [](const Wall&, const Wall&) { return false; });
  system.bodies.place_of_grain = inverse(system.bodies.grain_of);
  system.walls.place_of_wall = inverse(system.walls.wall_of);
  system.scene = scene;
  for (std::size_t k = 0; k < scene.grains.size(); ++k) {
    const Grain& grain = scene.grains[system.bodies.grain_of[k]];
    system.scene.grains[k] = grain;
    system.bodies.constants.push_back({grain.radius, 1 / grain.inertia.mass, 1 / grain.inertia.moment, grain.kind});
    system.bodies.motions.push_back({grain.position, grain.velocity, grain.spin, grain.angle});
  }
  for (std::size_t k = 0; k < scene.walls.size(); ++k) system.scene.walls[k] = scene.walls[system.walls.wall_of[k]];
  system.walls.given = system.scene.walls;
  system.bodies.impulses.resize(scene.grains.size());
  system.walls.places.resize(scene.walls.size());
  system.walls.loads.resize(scene.walls.size());
  place_parts(system);
}

}  // namespace equidem
