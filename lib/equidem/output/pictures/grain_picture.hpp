// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Pictures of colliding bodies, walls and the paths of a few bodies.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "equidem/core/vector.hpp"
#include "equidem/grains/scene/grain_scene.hpp"

namespace equidem {

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
