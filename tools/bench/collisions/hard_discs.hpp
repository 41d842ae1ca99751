// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The limit of all laws: rigid discs, impacts without duration.
#pragma once

#include "equidem/grains/scene/grain_scene.hpp"

namespace equidem::bench {

/// Equal discs of equal mass between lines, without gravity and friction, from impact to impact; at the time asked for.
/// \param impacts how many there were
std::vector<Grain> hard_discs_at(const GrainScene& scene, double time, int& impacts);

}  // namespace equidem::bench
