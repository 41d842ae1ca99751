// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Walls and gravity: the part of a scene that bonded and colliding bodies share.
#pragma once

#include <vector>

#include "equidem/core/vector.hpp"
#include "equidem/motion/wall.hpp"

namespace equidem {

/// Base of Scene (bonded discs) and GrainScene (colliding bodies).
struct AnyScene {
  std::vector<Wall> walls = {};
  Vec2 gravity = {};  ///< m/s²

  [[nodiscard]] bool weighs() const { return gravity != Vec2{}; }
};

}  // namespace equidem
