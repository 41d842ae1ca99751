// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Boxes to fill, for tests.
#pragma once

#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "equidem/material/spring_relations.hpp"
#include "equidem/packing/packing.hpp"
#include "equidem/packing/size_distribution.hpp"

namespace equidem {

inline double area_of_discs(std::span<const double> radii) {
  return area_of(PackingShape{}, radii);
}

inline std::vector<Vec2> centres_of(const GrainPacking& packing) {
  std::vector<Vec2> centres;
  for (const Grain& grain : packing.grains) centres.push_back(grain.position);
  return centres;
}

/// A packing of given discs.
inline GrainPacking packing_of(const PackingBox& box, std::vector<Vec2> centres, std::vector<double> radii) {
  GrainPacking packing;
  packing.box = box;
  make_grains({}, {std::move(centres), std::move(radii), {}}, 1, packing);
  return packing;
}

/// Discs of 5 to 10 mm in a square that they fill to the solid fraction.
inline PackingOptions square_box(PackingMethod method, PackingBox::Sides sides, std::int64_t discs,
                                 double solid_fraction) {
  PackingOptions options;
  options.method = method;
  Random random(11);
  options.radii = draw_radii({.smallest = 0.005, .largest = 0.01}, discs, random);
  const double side = std::sqrt(area_of_discs(options.radii) / solid_fraction);
  options.box = {{side, side}, sides};
  return options;
}

/// Soil discs that fall into a box.
inline PackingOptions falling_soil(std::int64_t discs, double width) {
  PackingOptions options = square_box(PackingMethod::falling, PackingBox::Sides::open_top, discs, 0.5);
  options.box.size = {width, 0};
  options.settling.springs = springs_of_wave_speeds(options.settling.density, wave_speeds_from_shear(150, 0.25));
  return options;
}

/// Largest overlap of two discs over the smaller radius, and of discs and walls, by comparing all.
inline double largest_overlap(const GrainPacking& packing) {
  double largest = 0;
  for (std::size_t i = 0; i < packing.size(); ++i) {
    const Vec2 x = packing.grains[i].position;
    const double r = packing.radii[i];
    if (!packing.box.periodic()) {
      for (const double gap : {x.x, x.y, packing.box.size.x - x.x, packing.box.size.y - x.y})
        largest = std::max(largest, (r - gap) / r);
    }
    for (std::size_t j = i + 1; j < packing.size(); ++j) {
      Vec2 way = packing.grains[j].position - x;
      if (packing.box.periodic()) {
        way.x -= packing.box.size.x * std::round(way.x / packing.box.size.x);
        way.y -= packing.box.size.y * std::round(way.y / packing.box.size.y);
      }
      largest = std::max(largest, (r + packing.radii[j] - norm(way)) / std::min(r, packing.radii[j]));
    }
  }
  return largest;
}

}  // namespace equidem
