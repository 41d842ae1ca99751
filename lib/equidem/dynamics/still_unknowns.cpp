// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/dynamics/still_unknowns.hpp"

#include <vector>

namespace equidem {

DegreesOfFreedom unknowns_at(const Scene& scene, const Effects& effects, double time) {
  std::vector<Support> supports;
  for (const TimedSupport& timed : scene.supports) {
    Support support;
    support.group = timed.group;
    if (timed.ux) support.ux = timed.ux->at(time);
    if (timed.uy) support.uy = timed.uy->at(time);
    if (timed.rotation && effects.rotation) support.rotation = timed.rotation->at(time);
    supports.push_back(support);
  }
  return number_unknowns(scene.assembly, scene.springs, effects, supports);
}

}  // namespace equidem
