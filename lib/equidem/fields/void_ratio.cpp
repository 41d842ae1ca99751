// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/fields/void_ratio.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/fields/surface.hpp"

namespace equidem {
namespace {

constexpr double side_strip = 2, surface_strip = 3, least = 2;  // mean diameters

/// Along y for a wall along x; 0: it stands askew.
Vec2 normal_of(const Wall& wall) {
  Vec2 normal = wall.normal;
  if (wall.shape == Wall::Shape::segment) normal = perpendicular(wall.end - wall.point) / norm(wall.end - wall.point);
  constexpr double straight = 1e-9;
  if (std::abs(normal.x) < straight) return {0, 1};
  if (std::abs(normal.y) < straight) return {1, 0};
  return {};
}

}  // namespace

GrainBox box_of(std::span<const Wall> walls, std::span<const Grain> grains, double time) {
  if (grains.empty()) bad_input("a box without grains", "there is nothing to measure", "Add some");
  GrainBox box{.inside = {{INFINITY, INFINITY}, {-INFINITY, -INFINITY}}};
  Vec2 middle;
  for (const Grain& grain : grains) {
    box.inside.low = {std::min(box.inside.low.x, grain.position.x - grain.radius),
                      std::min(box.inside.low.y, grain.position.y - grain.radius)};
    box.inside.high = {std::max(box.inside.high.x, grain.position.x + grain.radius),
                       std::max(box.inside.high.y, grain.position.y + grain.radius)};
    middle += grain.position / static_cast<double>(grains.size());
  }
  Region walled{{-INFINITY, -INFINITY}, {INFINITY, INFINITY}};
  for (const Wall& wall : walls) {
    const Vec2 normal = normal_of(wall);
    const Vec2 place = wall.point + wall.displacement(time);
    if (normal.x != 0 && place.x < middle.x) walled.low.x = std::max(walled.low.x, place.x);
    if (normal.x != 0 && place.x >= middle.x) walled.high.x = std::min(walled.high.x, place.x);
    if (normal.y != 0 && place.y < middle.y) walled.low.y = std::max(walled.low.y, place.y);
    if (normal.y != 0 && place.y >= middle.y) walled.high.y = std::min(walled.high.y, place.y);
  }
  box.lid = std::isfinite(walled.high.y);
  const auto put = [](double& side, double wall) {
    if (std::isfinite(wall)) side = wall;
  };
  put(box.inside.low.x, walled.low.x);
  put(box.inside.low.y, walled.low.y);
  put(box.inside.high.x, walled.high.x);
  put(box.inside.high.y, walled.high.y);
  return box;
}

double mean_diameter(std::span<const Grain> grains, std::span<const Clump> clumps) {
  double sum = 0;
  for (const Grain& grain : grains)
    sum +=
        grain.shape() == GrainShape::disc ? 2 * grain.radius : 2 * std::sqrt(area_of(grain, clumps) / std::numbers::pi);
  return sum / static_cast<double>(grains.size());
}

std::optional<Region> measured_region(std::span<const Grain> grains, std::span<const Clump> clumps, const GrainBox& box,
                                      std::span<const char> heap) {
  const double diameter = mean_diameter(grains, clumps);
  const Vec2 strip{side_strip * diameter, side_strip * diameter};
  Region region{box.inside.low + strip, box.inside.high - strip};
  if (!box.lid) {
    double largest = 0;
    for (const Grain& grain : grains) largest = std::max(largest, grain.radius);
    const double width = box.inside.high.x - box.inside.low.x;
    const auto columns = std::max<std::size_t>(1, static_cast<std::size_t>(width / (4 * largest)));
    const SurfaceProfile surface = surface_of(grains, clumps, box.inside.low.x, box.inside.high.x, columns, heap);
    for (const double height : surface.heights) {
      // A column without bodies is open to the floor.
      const double top = std::isnan(height) ? box.inside.low.y : height;
      region.high.y = std::min(region.high.y, top - surface_strip * diameter);
    }
  }
  const Vec2 size = region.high - region.low;
  if (!(size.x >= least * diameter && size.y >= least * diameter)) return {};
  return region;
}

SolidMeasures measure_solids(std::span<const Grain> grains, std::span<const Clump> clumps, const Region& region) {
  const Vec2 sides = region.high - region.low;
  if (!(sides.x > 0 && sides.y > 0)) {
    bad_input(fmt::format("the region measured is {} m wide and {} m high", sides.x, sides.y), "it has no area",
              "Give its lower left corner first");
  }
  double covered = 0;
  for (const Grain& grain : grains) covered += clipped_area(grain, clumps, region);
  SolidMeasures measures;
  measures.solid_fraction = covered / region.area();
  measures.porosity = 1 - measures.solid_fraction;
  measures.void_ratio = measures.porosity / measures.solid_fraction;
  return measures;
}

}  // namespace equidem
