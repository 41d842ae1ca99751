// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The discs of a clump at the present position of its body.
#pragma once

#include <numbers>

#include "equidem/core/turns.hpp"
#include "equidem/core/vector.hpp"
#include "equidem/grains/scene/grain_scene.hpp"

namespace equidem {

/// Rotation of a vector from the frame of a body.
/// \param angle of the body, rad
inline Vec2 turned(Vec2 vector, double angle) {
  const double turns = angle / (2 * std::numbers::pi);
  return sine_of_turns(turns + 0.25) * vector + sine_of_turns(turns) * perpendicular(vector);
}

}  // namespace equidem
