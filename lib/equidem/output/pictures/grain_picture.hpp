// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Bodies that collide in a picture, and as a film of an HTML page.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "equidem/core/vector.hpp"
#include "equidem/grains/scene/grain_scene.hpp"
#include "equidem/motion/wall.hpp"
#include "equidem/output/pictures/canvas.hpp"

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
  std::optional<PeriodicCell> cell = {};  ///< its frame, and paler the images of grains that reach into it
  std::span<const Grain> started = {};    ///< the scene before it moved, by which grains are left out; empty: none is
  /// Places of all grains at moments, NaN where one was not there; empty: no paths.
  std::span<const std::vector<Vec2>> paths = {};
};

/// Write NAME.png, 1000 pixels wide, and NAME.svg where no more than most_drawn_discs are drawn. The view holds grains,
/// their paths, segments; lines are clipped to it. Without paths, grains are left out that lie farther from the box
/// round the segments and the grains that started than half its larger side, unless all do. The caption states how many
/// are shown.
/// \throws Error (bad_input) without grains, on places that are not finite, and as write_file does
void write_grain_picture(const std::filesystem::path& folder, const std::string& name, const GrainPicture& picture,
                         bool overwrite);

/// Positions of all bodies at one time.
struct GrainFrame {
  double time = 0;               ///< s, by which walls have moved
  std::vector<Vec2> places;      ///< m; NaN: not there
  std::vector<double> angles;    ///< rad
  std::vector<Vec2> walls = {};  ///< places of Wall::point, m; NaN: not there; empty: by the schedules of the walls
};

struct GrainAnimation {
  std::string title = {};
  std::string caption = {};            ///< a line under the picture, such as what the colours mean
  std::span<const Grain> shapes = {};  ///< their positions are not used
  std::span<const Clump> clumps = {};
  std::span<const int> groups = {};  ///< of each grain: its colour; empty: all alike
  std::span<const Wall> walls = {};
  std::span<const Grain> started = {};  ///< the scene before it moved, by which grains are left out; empty: none is
  std::span<const GrainFrame> frames = {};
  double speed = 1;        ///< of the picture, in seconds of motion per second
  bool by_motion = false;  ///< bodies are the bluer the further they are from their places in the first frame
};

/// The part of a page that plays the frames: canvas, button, slider, clock and script.
/// \throws Error (bad_input) on a place that is not finite
std::string grain_animation_player(const GrainAnimation& animation);

}  // namespace equidem
