// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The part of the plane that pictures of colliding bodies show.
/// Pictures of colliding bodies, walls and the paths of a few bodies.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
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

/// Largest number of grains whose paths are drawn; more are illegible.
inline constexpr std::size_t most_drawn_paths = 60;

struct GrainPicture {
  std::string title = {};
  double time = 0;  ///< s, by which walls have moved
  std::span<const Grain> grains = {};
  std::span<const Clump> clumps = {};
  std::span<const int> groups = {};       ///< of each grain: its colour; empty: all alike
  std::span<const GrainBond> bonds = {};  ///< lines from centre to centre
  std::span<const Wall> walls = {};
  std::span<const Grain> started = {};  ///< the scene before it moved, by which grains are left out; empty: none is
  /// Places of all grains at moments, NaN where one was not there; empty: no paths.
  std::span<const std::vector<Vec2>> paths = {};
};

/// Write NAME.png, 1000 pixels wide, and NAME.svg where no more than most_drawn_discs (picture.hpp) are drawn. The view
/// holds grains, their paths, segments; lines are clipped to it. Without paths, grains are
/// left out that have fallen out of the scene (near_the_scene), unless all have. The caption tells how many are shown.
/// \throws Error (bad_input) without grains, on places that are not finite, and as write_file does
std::vector<std::filesystem::path> write_grain_picture(const std::filesystem::path& folder, const std::string& name,
                                                       const GrainPicture& picture, bool overwrite);

}  // namespace equidem
