// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Contacts computed one by one, to compare with those computed several at a time.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "grains/scenes.hpp"

namespace equidem::test {

/// The options for contacts one by one.
inline GrainOptions one_by_one(GrainOptions options) {
  options.one_by_one = true;
  return options;
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
