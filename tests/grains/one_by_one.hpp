// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Contacts computed one by one, to compare with those computed several at a time.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "grains/scenes.hpp"

namespace equidem::test {

/// The scene with an added kind that no body has. Its contacts always slide among themselves and have springs with the
/// rest: a scene with both computes contacts one by one.
inline GrainScene one_by_one(GrainScene scene) {
  PairProperties sprung = scene.pairs[0], sliding = scene.pairs[0];
  sprung.friction = sliding.friction = 0.1;
  sprung.tangential_ratio = 0.5;
  sliding.tangential_ratio = 0;
  sliding.tangential_damping = 0;
  const int kinds = scene.kinds;
  std::vector<PairProperties> pairs;
  for (int a = 0; a <= kinds; ++a) {
    for (int b = 0; b <= kinds; ++b) {
      pairs.push_back(a < kinds && b < kinds ? scene.between(a, b) : a == b ? sliding : sprung);
    }
  }
  scene.kinds = kinds + 1;
  scene.pairs = pairs;
  return scene;
}

inline double distance_of_motions(const GrainSimulation& a, const GrainSimulation& b) {
  const std::vector<Grain> here = a.grains(), there = b.grains();
  double largest = 0;
  for (std::size_t k = 0; k < std::min(here.size(), there.size()); ++k) {
    largest = std::max({largest, norm(here[k].position - there[k].position), norm(here[k].velocity - there[k].velocity),
                        std::abs(here[k].spin - there[k].spin), std::abs(here[k].angle - there[k].angle)});
  }
  return largest;
}

}  // namespace equidem::test
