// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/grains/scene/clump.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/grains/scene/clipped_area.hpp"

namespace equidem {

Clump centred_clump(std::vector<Clump::Disc> discs) {
  if (discs.empty()) bad_input("a clump has no discs", "there is nothing to it", "Give at least one");
  for (const Clump::Disc& disc : discs) {
    if (std::isfinite(disc.offset.x + disc.offset.y) && disc.radius > 0 && std::isfinite(disc.radius)) continue;
    bad_input(fmt::format("a disc of a clump has the radius {} m and is at ({}, {}) m", disc.radius, disc.offset.x,
                          disc.offset.y),
              "it would touch nothing", "Give a radius > 0 and finite numbers");
  }
  for (std::size_t p = 0; p < discs.size(); ++p) {
    for (std::size_t q = 0; q < discs.size(); ++q) {
      // A disc that touches the other from inside adds nothing either, whatever rounding says.
      const double reach = norm(discs[p].offset - discs[q].offset) + discs[p].radius;
      if (p == q || reach > discs[q].radius * (1 + 1e-12)) continue;
      bad_input(fmt::format("disc {} of a clump lies within disc {}", p, q),
                "it adds nothing to the body, and where the two meet others contacts would count twice",
                "Leave it out");
    }
  }
  const Vec2 centre = union_of(discs).centre;
  for (Clump::Disc& disc : discs) disc.offset -= centre;
  return {std::move(discs)};
}

Inertia inertia_of_clump(const Clump& clump, double density) {
  if (!(density > 0 && std::isfinite(density))) {
    bad_input(fmt::format("the density of the clumps is {:.6g} kg/m³", density), "it must be positive and finite",
              "Give a density above 0 kg/m³");
  }
  const DiscUnion all = union_of(clump.discs);
  return {density * all.area, density * all.polar_moment};
}

double radius_of(const Clump& clump) {
  double radius = 0;
  for (const Clump::Disc& disc : clump.discs) radius = std::max(radius, norm(disc.offset) + disc.radius);
  return radius;
}

}  // namespace equidem
