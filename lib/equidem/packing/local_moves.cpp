// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "equidem/core/error.hpp"
#include "equidem/core/progress.hpp"
#include "equidem/core/random.hpp"
#include "equidem/core/text.hpp"
#include "equidem/packing/packing.hpp"
#include "equidem/packing/placed_discs.hpp"

namespace equidem {
namespace {

/// How much a disc at a place overlaps others and walls: sum of squares, and the largest one, m.
struct Crowding {
  double squares = 0, largest = 0;
  void add(double overlap) {
    if (overlap <= 0) return;
    squares += overlap * overlap;
    largest = std::max(largest, overlap);
  }
};

Crowding crowding(const PlacedDiscs& placed, const PackingBox& box, std::int32_t disc, Vec2 place, double radius) {
  Crowding sum;
  placed.any_near(place, [&](std::int32_t other) {
    if (other == disc) return false;
    const auto k = static_cast<std::size_t>(other);
    const Vec2 way = placed.branch(place, placed.centres()[k]);
    const double reach = placed.radii()[k] + radius, square = dot(way, way);
    if (square < reach * reach) sum.add(reach - std::sqrt(square));
    return false;
  });
  if (!box.periodic()) {
    for (const double gap : {place.x, box.size.x - place.x, place.y, box.size.y - place.y}) sum.add(radius - gap);
  }
  return sum;
}

}  // namespace

/// Monte Carlo without temperature: a random move of a disc that overlaps is taken where it overlaps less afterwards, one that lies
/// free is shaken. Radii are
/// larger by a little than they should be, so that the discs end apart.
void fill_by_local_moves(const PackingOptions& options, DiscPacking& packing) {
  const double spare = std::max(options.overlap, 1e-4);
  Random random(options.seed);
  const double largest = *std::max_element(options.radii.begin(), options.radii.end());
  PlacedDiscs placed(options.box, (1 + spare) * largest);
  for (const double radius : options.radii) {
    const double margin = options.box.periodic() ? 0 : radius;
    const double x = random.uniform(margin, options.box.size.x - margin);
    placed.add({x, random.uniform(margin, options.box.size.y - margin)}, (1 + spare) * radius);
  }
  Progress progress("moving");
  constexpr double shake = 0.05;  // of the radius
  constexpr int moves = 4;
  double deepest = 0;
  for (std::int64_t sweep = 0; sweep < options.attempts; ++sweep) {
    progress.update(static_cast<double>(sweep) / static_cast<double>(options.attempts));
    ++packing.work;
    deepest = 0;
    std::int64_t overlapping = 0;
    for (std::size_t k = 0; k < options.radii.size(); ++k) {
      const auto disc = static_cast<std::int32_t>(k);
      const double radius = placed.radii()[k];
      Crowding here = crowding(placed, options.box, disc, placed.centres()[k], radius);
      const bool lies_free = here.largest <= spare * options.radii[k];
      if (!lies_free) {
        ++overlapping;
        deepest = std::max(deepest, here.largest / radius);
      }
      // Discs that lie free are shaken, too: they make room for others.
      const double reach = lies_free ? shake * radius : 1.2 * here.largest;
      for (int move = 0; move < (lies_free ? 1 : moves); ++move) {
        const double dx = random.uniform(-reach, reach);
        const Vec2 place = placed.wrapped(placed.centres()[k] + Vec2{dx, random.uniform(-reach, reach)});
        const Crowding there = crowding(placed, options.box, disc, place, radius);
        if (lies_free ? there.squares > 0 : there.squares >= here.squares) continue;
        placed.move(disc, place);
        here = there;
      }
    }
    if (overlapping > 0) continue;
    packing.centres = placed.centres();
    packing.radii = options.radii;
    return;
  }
  computation_failed(format("after {} sweeps discs still overlap by {:.2g} of a radius at a solid fraction of {:.4g}",
                            options.attempts, deepest, area_of_discs(options.radii) / options.box.area()),
                     "small random moves find the way apart ever more slowly as the box fills",
                     "Ask for less, for more attempts, or use growth");
}

}  // namespace equidem
