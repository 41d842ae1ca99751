// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A gas of equal discs in a box, and its motion in the limit that all laws share: rigid discs, impacts without
/// duration.
#pragma once

#include <vector>

#include "equidem/grains/scene/grain_scene.hpp"

namespace equidem::bench {

inline constexpr double radius = 0.5;  ///< m, of all discs; their mass is 1 kg
Grain disc_at(Vec2 position, Vec2 velocity = {});

/// Discs in a square box on a grid of the given solid fraction, with velocities of 1 m/s in random directions.
GrainScene gas(int discs, double fraction, const PairProperties& pair);

struct HardDiscs {
  std::vector<Vec2> positions;
  int impacts = 0;
};
/// Discs of equal mass with one restitution between lines at rest, without gravity and friction, moved from impact to
/// impact until `time`, s.
HardDiscs hard_discs_at(const GrainScene& scene, double time);

}  // namespace equidem::bench
