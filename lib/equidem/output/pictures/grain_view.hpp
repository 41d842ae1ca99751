// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The part of the plane that pictures of colliding bodies show.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "equidem/core/vector.hpp"
#include "equidem/grains/scene/grain_scene.hpp"
#include "equidem/motion/wall.hpp"
#include "equidem/output/pictures/scene.hpp"

namespace equidem {

struct GrainView : Bounds {
  /// \throws Error (bad_input) where position or angle of the grain are not finite
  void include_grain(std::size_t grain, Vec2 centre, double angle, double radius);
  /// Segments; lines cross the view.
  void include_walls(std::span<const Wall> walls, double time);
  /// Adds a margin, and room where the view is very narrow or flat.
  void widen();
  [[nodiscard]] Vec2 size() const { return high - low; }
};

/// Which of the places of grains at a time belong to an open scene: they lie no farther from the box round the
/// segments and the grains that started than half its larger side. Others have fallen out of it. Empty: all
/// belong, because there are lines alone or no grain is known to have started.
std::vector<bool> near_the_scene(std::span<const Vec2> places, std::span<const Grain> started,
                                 std::span<const Wall> walls, double time);

/// Both ends of a segment.
std::vector<Vec2> outline(const Wall& segment, double time);

}  // namespace equidem
