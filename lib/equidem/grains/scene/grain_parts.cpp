// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/grains/scene/grain_parts.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <tuple>

#include "equidem/core/turns.hpp"

namespace equidem {

bool has_shapes(const GrainScene& scene) {
  return std::any_of(scene.grains.begin(), scene.grains.end(),
                     [](const Grain& grain) { return grain.shape() != GrainShape::disc; });
}

std::vector<GrainPart> parts_of(const Grain& grain, const std::vector<Clump>& clumps) {
  switch (grain.shape()) {
    case GrainShape::disc:
      return {{{}, grain.radius, grain.radius, grain.radius}};
    case GrainShape::ellipse:
      return {{{}, grain.radius, grain.short_half_axis, std::sqrt(grain.radius * grain.short_half_axis)}};
    case GrainShape::clump:
      break;
  }
  std::vector<GrainPart> parts;
  for (const Clump::Disc& disc : clumps[static_cast<std::size_t>(grain.clump)].discs) {
    parts.push_back({disc.offset, disc.radius, disc.radius, disc.radius});
  }
  const auto place = [](const GrainPart& part) { return std::tuple(part.offset.x, part.offset.y, part.a); };
  std::sort(parts.begin(), parts.end(), [&](const GrainPart& p, const GrainPart& q) { return place(p) < place(q); });
  return parts;
}

double inscribed_radius(const Grain& grain, std::span<const Clump> clumps) {
  switch (grain.shape()) {
    case GrainShape::clump:
      return std::ranges::min(clumps[static_cast<std::size_t>(grain.clump)].discs, {}, &Clump::Disc::radius).radius;
    case GrainShape::ellipse:
      return grain.short_half_axis;
    case GrainShape::disc:
      break;
  }
  return grain.radius;
}

double smallest_inscribed_radius(const GrainScene& scene) {
  double smallest = std::numeric_limits<double>::infinity();
  for (const Grain& grain : scene.grains) smallest = std::min(smallest, inscribed_radius(grain, scene.clumps));
  return smallest;
}

Vec2 axis_at(double angle) {
  const double turns = angle / (2 * std::numbers::pi);
  return {sine_of_turns(turns + 0.25), sine_of_turns(turns)};
}

}  // namespace equidem
