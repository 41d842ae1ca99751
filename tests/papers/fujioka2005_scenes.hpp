// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The scenes of Fujioka & Ushijima (2005), section 5.
#pragma once

#include <cmath>

#include "equidem/grains/grain_simulation.hpp"

namespace fujioka2005 {

using namespace equidem;

constexpr double diameter = 225, drop = 0.01, gravity = 9.8;  // m, diameters, m/s²
constexpr double stacked_radius = 0.02;                       // m

/// e = 0.7 and the stiffness that Table 2 gives away.
inline PairProperties pair_of(NormalLaw law, double e = 0.7) {
  return {.dimensionless = law == NormalLaw::hertz_dashpot ? 4.62 : 0.10,
          .restitution = e,
          .end = law == NormalLaw::exact_flow ? ContactEnd::at_zero_force : ContactEnd::at_zero_overlap};
}

inline Grain ball_at(equidem::Vec2 position, double radius) {
  return {.position = position, .radius = radius, .inertia = inertia_of(radius, 1, Body::sphere)};
}

inline GrainScene on_floor(const PairProperties& pair) {
  GrainScene scene;
  scene.walls.emplace_back();
  scene.gravity = {0, -gravity};
  scene.pairs = {pair};
  return scene;
}

/// Balls over one another and a floor at y = 0, all gaps 0.01 diameters.
inline GrainScene column(const PairProperties& pair, int balls) {
  GrainScene scene = on_floor(pair);
  for (int k = 0; k < balls; ++k) {
    scene.grains.push_back(ball_at({0, (k + 0.5 + (k + 1) * drop) * diameter}, 0.5 * diameter));
  }
  return scene;
}

/// Fig. 9: A and B on the floor, C upon them.
inline GrainScene stacked(const PairProperties& pair) {
  constexpr double r = stacked_radius;
  GrainScene scene = on_floor(pair);
  scene.grains = {ball_at({-r, r}, r), ball_at({r, r}, r), ball_at({0, (1 + std::sqrt(3.0)) * r}, r)};
  return scene;
}

inline GrainSimulation start(const GrainScene& scene, NormalLaw law, double step, bool refuse_crossing = true) {
  return {scene, {.law = law, .time_step = step, .refuse_crossing = refuse_crossing}};
}

}  // namespace fujioka2005
