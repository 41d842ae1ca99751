// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/output/pictures/grain_view.hpp"

#include <algorithm>
#include <cmath>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

namespace equidem {

void GrainView::include_grain(std::size_t grain, Vec2 centre, double angle, double radius) {
  if (!std::isfinite(centre.x + centre.y + angle))
    bad_input(fmt::format("grain {} at ({}, {}) cannot be drawn", grain, centre.x, centre.y), "its place is not finite",
              "Check the run that it comes from");
  include(centre, radius);
}

void GrainView::include_walls(std::span<const Wall> walls, double time) {
  for (const Wall& wall : walls) {
    if (wall.shape == Wall::Shape::line) continue;
    for (const Vec2 point : outline(wall, time)) include(point, 0);
  }
}

void GrainView::widen() {
  const double edge = 0.04 * larger_side();
  low -= Vec2{edge, edge};
  high += Vec2{edge, edge};
  const Vec2 missing{std::max(0.0, 0.5 * size().y - size().x), std::max(0.0, 0.25 * size().x - size().y)};
  low -= 0.5 * missing;
  high += 0.5 * missing;
}

std::vector<bool> near_the_scene(std::span<const Vec2> places, std::span<const Grain> started,
                                 std::span<const Wall> walls, double time) {
  const auto is_finite = [](const Wall& wall) { return wall.shape != Wall::Shape::line; };
  if (started.empty() || std::ranges::none_of(walls, is_finite)) return {};
  GrainView scene;
  for (const Grain& grain : started) scene.include(grain.position, grain.radius);
  scene.include_walls(walls, time);
  const double reach = 0.5 * scene.larger_side();
  std::vector<bool> near;
  for (const Vec2 place : places) {
    const Vec2 above = place - scene.low, below = scene.high - place;
    near.push_back(!(std::min({above.x, above.y, below.x, below.y}) < -reach));
  }
  return near;
}

std::vector<Vec2> outline(const Wall& segment, double time) {
  const Vec2 moved = segment.displacement(time);
  return {segment.point + moved, segment.end + moved};
}

}  // namespace equidem
