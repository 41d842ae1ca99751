// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Density of the bodies in a box, away from its walls and from their surface.
#pragma once

#include <optional>
#include <span>

#include "equidem/grains/scene/clipped_area.hpp"
#include "equidem/grains/scene/grain_scene.hpp"

namespace equidem {

/// The rectangle that walls leave for bodies.
struct GrainBox {
  Region inside;     ///< m; where there is no wall, as far as the bodies reach
  bool lid = false;  ///< a wall above
};

/// Lines and segments along the axes are its sides; each is on that side of the middle of all bodies on which it lies
/// at the start. \param time s, by which walls have moved
/// \throws Error (bad_input) without grains
GrainBox box_of(std::span<const Wall> walls, std::span<const Grain> grains, double time);

/// Mean diameter of circles with the areas of the bodies, m.
double mean_diameter(std::span<const Grain> grains, std::span<const Clump> clumps);

/// The box without strips of two mean diameters at its sides and, under an open top, without three below the lowest
/// place of the surface, seen in columns two largest diameters wide.
/// \param heap of each body: whether it belongs to the surface (heap_of); empty: all do
/// \return none where nothing as large as two diameters each way is left
std::optional<Region> measured_region(std::span<const Grain> grains, std::span<const Clump> clumps, const GrainBox& box,
                                      std::span<const char> heap = {});

/// Solid fraction, porosity n = 1 - solid fraction, void ratio e = n/(1 - n).
struct SolidMeasures {
  double solid_fraction = 0, porosity = 0, void_ratio = 0;
};

/// Exact areas; where two bodies overlap the overlap counts twice, as their solid does.
/// \throws Error (bad_input) on a region without area
SolidMeasures measure_solids(std::span<const Grain> grains, std::span<const Clump> clumps, const Region& region);

}  // namespace equidem
