// SPDX-License-Identifier: GPL-3.0-or-later
#include "papers/fujioka2005_scenes.hpp"

#include <cmath>
#include <numbers>

namespace equidem::fujioka2005 {
namespace {

GrainScene on_floor(const PairProperties& pair) {
  GrainScene scene;
  scene.walls.emplace_back();
  scene.gravity = {0, -gravity};
  scene.pairs = {pair};
  return scene;
}

/// A sphere of density 1 kg/m³.
Grain ball_at(Vec2 position, double radius) {
  return {.position = position, .radius = radius, .inertia = inertia_of(radius, 1, Body::sphere)};
}

}  // namespace

PairProperties pair_of(NormalLaw law, double e, std::optional<double> a) {
  return {.dimensionless = a.value_or(stiffness_of(law)),
          .restitution = e,
          .end = law == NormalLaw::exact_flow ? ContactEnd::at_zero_force : ContactEnd::at_zero_overlap};
}

GrainScene column(const PairProperties& pair, int balls, double gap, double size) {
  GrainScene scene = on_floor(pair);
  for (int k = 0; k < balls; ++k) scene.grains.push_back(ball_at({0, ((k + 0.5) + (k + 1) * gap) * size}, 0.5 * size));
  return scene;
}

GrainScene stacked(const PairProperties& pair) {
  constexpr double r = stacked_radius;
  GrainScene scene = on_floor(pair);
  scene.grains = {ball_at({-r, r}, r), ball_at({r, r}, r), ball_at({0, (1 + std::numbers::sqrt3) * r}, r)};
  return scene;
}

GrainSimulation start(const GrainScene& scene, NormalLaw law, double step, bool refuse_crossing) {
  return {scene, {.law = law, .time_step = step, .refuse_crossing = refuse_crossing}};
}

}  // namespace equidem::fujioka2005
