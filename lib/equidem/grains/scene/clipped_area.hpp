// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Areas of bodies, and of what of them lies in a rectangle, exactly.
#pragma once

#include <span>

#include "equidem/contact/shapes/ellipse.hpp"
#include "equidem/grains/scene/grain_scene.hpp"

namespace equidem {

/// A rectangle, m.
struct Region {
  Vec2 low, high;
  [[nodiscard]] double area() const { return (high.x - low.x) * (high.y - low.y); }
};

/// The area that a disc and a rectangle share, m².
double clipped_area(Vec2 centre, double radius, const Region& region);
/// The same of an ellipse.
double clipped_area(const Ellipse& ellipse, Vec2 centre, const Region& region);
/// The same of discs together: what several cover counts once.
double clipped_area(std::span<const Clump::Disc> discs, const Region& region);
/// The same of a grain of a scene.
double clipped_area(const Grain& grain, std::span<const Clump> clumps, const Region& region);

/// What discs cover together; what several cover counts once.
struct DiscUnion {
  double area = 0;          ///< m²
  Vec2 centre;              ///< of area, m
  double polar_moment = 0;  ///< integral of the squared distance from that centre, m⁴
};
DiscUnion union_of(std::span<const Clump::Disc> discs);

/// m²
double area_of(const Grain& grain, std::span<const Clump> clumps);

}  // namespace equidem
