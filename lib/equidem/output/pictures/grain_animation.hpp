// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Colliding bodies as a moving picture: one HTML file that holds all frames and needs nothing else.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "equidem/core/vector.hpp"
#include "equidem/grains/scene/grain_scene.hpp"

namespace equidem {

/// Positions of all bodies at one time.
struct GrainFrame {
  double time = 0;               ///< s, by which walls have moved
  std::vector<Vec2> places;      ///< m; NaN: not there
  std::vector<double> angles;    ///< rad
  std::vector<Vec2> walls = {};  ///< places of Wall::point, m; NaN: not there; empty: by the schedules of the walls
};
GrainFrame frame_of(std::span<const Grain> grains, double time);

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
/// \throws Error (bad_input) as grain_animation_html
std::string grain_animation_player(const GrainAnimation& animation);

/// The page. The view holds all bodies, segments at all times; of a line what crosses it. Bodies are left out
/// of the frames in which they have fallen out of the scene (near_the_scene), unless all have in all frames. Places are
/// rounded to 1/4096 of the view, angles to 1/4096 of a turn.
/// \throws Error (bad_input) without grains or frames, on frames of another number of bodies, on places that are not
///         finite
std::string grain_animation_html(const GrainAnimation& animation);

/// \throws Error (bad_input) as grain_animation_html and write_file
void write_grain_animation(const std::filesystem::path& path, const GrainAnimation& animation, bool overwrite);

}  // namespace equidem
