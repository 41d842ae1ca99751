// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/run_film.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "equidem/core/text.hpp"
#include "equidem/output/page/page.hpp"
#include "equidem/output/pictures/grain_picture.hpp"
#include "equidem/output/pictures/picture.hpp"

namespace equidem {
namespace {

constexpr std::size_t most_frames = 150, fewest_frames = 8;
constexpr double seconds_of_film = 8;

void add_player(GrainAnimation animation, std::span<const GrainFrame> frames) {
  animation.frames = frames;
  animation.speed = (frames.back().time - frames.front().time) / seconds_of_film;
  std::string title = animation.title.empty() ? "Motion" : animation.title;
  DrawnFigures::add({.name = "motion", .title = std::move(title), .player = grain_animation_player(animation)});
}

}  // namespace

std::int64_t frames_of_film(std::size_t bodies) {
  constexpr std::size_t room = 750'000, bytes_of_body = 17;  // of the page
  const std::size_t frames = std::min(most_frames, room / (bytes_of_body * std::max<std::size_t>(1, bodies)));
  return frames < fewest_frames ? 0 : static_cast<std::int64_t>(frames);
}

void add_film(const std::string& title, const Assembly& assembly, std::span<const FilmFrame> frames) {
  if (frames.size() < 2) return;
  Bounds rest;
  double largest = 0;
  std::vector<Grain> shapes(assembly.size());
  for (std::size_t disc = 0; disc < assembly.size(); ++disc) {
    rest.include(assembly.centres[disc], assembly.radii[disc]);
    shapes[disc].radius = assembly.radii[disc];
    for (const FilmFrame& frame : frames) largest = std::max(largest, norm(frame.motions[disc].u));
  }
  const double scale = visible_scale(largest, rest.larger_side());
  std::vector<GrainFrame> enlarged;
  for (const FilmFrame& frame : frames) {
    GrainFrame& shown = enlarged.emplace_back(GrainFrame{.time = frame.time, .places = {}, .angles = {}});
    for (std::size_t disc = 0; disc < assembly.size(); ++disc) {
      shown.places.push_back(assembly.centres[disc] + scale * frame.motions[disc].u);
      shown.angles.push_back(scale * frame.motions[disc].theta);
    }
  }
  add_player({.title = title,
              .caption = fmt::format("Displacements {}; the bluer a disc, the further it is from where it began",
                                     scale == 1 ? "to scale" : fmt::format("× {:.6g}", scale)),
              .shapes = shapes,
              .by_motion = true},
             enlarged);
}

void add_film(const GrainCase& resolved, std::span<const Wall> walls, std::span<const int> colours,
              std::span<const Grain> started, std::span<const FilmFrame> frames) {
  if (frames.size() < 2) return;
  std::vector<GrainFrame> places;
  for (const FilmFrame& frame : frames) {
    GrainFrame& shown = places.emplace_back(GrainFrame{.time = frame.time, .places = {}, .angles = {}});
    for (const DiscMotion& motion : frame.motions) {
      shown.places.push_back(motion.u);
      shown.angles.push_back(motion.theta);
    }
    shown.walls = frame.walls;
  }
  const std::vector<Grain> bodies = resolved.bodies();
  add_player({.title = resolved.title,
              .caption = "The line in a body shows how it turns",
              .shapes = bodies,
              .clumps = resolved.scene.clumps,
              .groups = colours,
              .walls = walls,
              .started = started},
             places);
}

}  // namespace equidem
