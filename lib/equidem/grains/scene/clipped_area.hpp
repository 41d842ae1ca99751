// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Exact areas of bodies and of their parts within a rectangle.
#pragma once

#include <span>

#include "equidem/assembly/assembly.hpp"
#include "equidem/contact/shapes/ellipse_contact.hpp"
#include "equidem/grains/scene/grain_scene.hpp"

namespace equidem {

/// Area of the intersection of a disc and a rectangle, m².
double clipped_area(Vec2 centre, double radius, const Rectangle& region);
/// Area of the intersection of an ellipse and a rectangle, m².
double clipped_area(const Ellipse& ellipse, Vec2 centre, const Rectangle& region);
/// Area of the intersection of a union of discs and a rectangle, m².
double clipped_area(std::span<const Clump::Disc> discs, const Rectangle& region);
/// Area of the intersection of a grain and a rectangle, m².
double clipped_area(const Grain& grain, std::span<const Clump> clumps, const Rectangle& region);
/// That of all grains; where two overlap the overlap counts twice, as their solid does.
double clipped_area(std::span<const Grain> grains, std::span<const Clump> clumps, const Rectangle& region);

/// Area moments of a union of discs.
struct DiscUnion {
  double area = 0;          ///< m²
  Vec2 centre;              ///< centroid, m
  double polar_moment = 0;  ///< integral of the squared distance from the centroid, m⁴
};
DiscUnion union_of(std::span<const Clump::Disc> discs);

/// Area of a grain, m².
double area_of(const Grain& grain, std::span<const Clump> clumps);

}  // namespace equidem
