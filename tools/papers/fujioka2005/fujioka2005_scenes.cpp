// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <numbers>

#include "equidem/core/text.hpp"

#include "fujioka2005/fujioka2005.hpp"

namespace equidem::fujioka2005 {
namespace {

constexpr double density = 1;  // kg/m³

GrainScene on_floor(const Variant& variant, double e) {
  GrainScene scene;
  scene.walls.emplace_back();
  scene.gravity = {0, -gravity};
  scene.pairs = {pair_of(variant, e)};
  return scene;
}

Grain ball_at(Vec2 position, double a) {
  return {.position = position, .radius = a, .inertia = inertia_of(a, density, Body::sphere)};
}

}  // namespace

std::vector<Variant> variants(double stiff) {
  return {{NormalLaw::linear_dashpot, of_springs, "C"}, {NormalLaw::hertz_dashpot, of_hertz, "T"},
          {NormalLaw::five_case_map, of_springs, "F"},  {NormalLaw::energy_map, of_springs, "P"},
          {NormalLaw::exact_flow, of_springs, "X"},     {NormalLaw::exact_flow, stiff, "X stiff"}};
}

PairProperties pair_of(const Variant& variant, double e) {
  return {.dimensionless = variant.a,
          .restitution = e,
          .end = variant.of_paper() ? ContactEnd::at_zero_overlap : ContactEnd::at_zero_force};
}

GrainScene column(const Variant& variant, int balls, double gap, double e) {
  GrainScene scene = on_floor(variant, e);
  for (int k = 0; k < balls; ++k) {
    scene.grains.push_back(ball_at({0, ((k + 0.5) + (k + 1) * gap) * diameter}, 0.5 * diameter));
  }
  return scene;
}

GrainScene stacked(const Variant& variant) {
  constexpr double r = stacked_radius;
  GrainScene scene = on_floor(variant, restitution);
  scene.grains = {ball_at({-r, r}, r), ball_at({r, r}, r), ball_at({0, (1 + std::numbers::sqrt3) * r}, r)};
  return scene;
}

GrainSimulation start(const GrainScene& scene, const Variant& variant, double step, bool refuse_crossing) {
  return {scene, {.law = variant.law, .time_step = step, .refuse_crossing = refuse_crossing}};
}

}  // namespace equidem::fujioka2005
