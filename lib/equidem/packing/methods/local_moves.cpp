// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <numbers>
#include <vector>

#include "equidem/core/error.hpp"
#include "equidem/core/random.hpp"
#include "equidem/core/stopwatch.hpp"
#include "equidem/core/text.hpp"
#include "equidem/packing/packing.hpp"
#include "equidem/packing/placed_bodies.hpp"

namespace equidem {
namespace {

/// Overlaps of a body at a place with others and walls: sum of squares, m², and the largest one, m.
struct Crowding {
  double squares = 0, largest = 0;
  void add(double overlap) {
    if (overlap <= 0) return;
    squares += overlap * overlap;
    largest = std::max(largest, overlap);
  }
};

Crowding crowding(const PlacedBodies& placed, std::int32_t body, Placement there) {
  Crowding sum;
  placed.any_overlap(there.place, placed.radius(static_cast<std::size_t>(body)), there.turns, body,
                     [&](double overlap) {
                       sum.add(overlap);
                       return false;
                     });
  return sum;
}

}  // namespace

/// Monte Carlo without temperature: a random move of a body that overlaps is taken where it overlaps less afterwards,
/// one that lies free is shaken. Discs are larger by a little than they should be, so that they end apart.
void fill_by_local_moves(const PackingOptions& options, GrainPacking& packing) {
  const bool discs = options.shape.is_disc();
  const double spare = discs ? std::max(options.overlap, 1e-4) : 0;
  const double smallest = *std::min_element(options.radii.begin(), options.radii.end());
  Random random(options.seed);
  std::vector<double> radii = options.radii;
  for (double& radius : radii) radius *= 1 + spare;
  PlacedBodies placed(options.box, unit_body_of(options.shape), radii);
  for (std::size_t k = 0; k < radii.size(); ++k) {
    const Placement there = placement_at_random(options, placed.shape(), options.radii[k], random);
    placed.add(there.place, radii[k], there.turns);
  }
  Progress progress("moving");
  constexpr double shake = 0.05;  // of the radius
  constexpr int moves = 4;
  double deepest = 0;
  keep_failure(packing, [&] {
    for (std::int64_t sweep = 0; sweep < options.attempts; ++sweep) {
      progress.update(static_cast<double>(sweep) / static_cast<double>(options.attempts));
      ++packing.work;
      deepest = 0;
      std::int64_t overlapping = 0;
      for (std::size_t k = 0; k < radii.size(); ++k) {
        const auto body = static_cast<std::int32_t>(k);
        Placement at = {placed.centre(k), placed.turns(k)};
        Crowding here = crowding(placed, body, at);
        const bool lies_free = here.largest <= (discs ? spare * options.radii[k] : options.overlap * smallest);
        if (!lies_free) {
          ++overlapping;
          deepest = std::max(deepest, here.largest / radii[k]);
        }
        // Bodies that lie free are shaken, too: they make room for others.
        const double reach = lies_free ? shake * radii[k] : 1.2 * here.largest;
        for (int move = 0; move < (lies_free ? 1 : moves); ++move) {
          const double dx = random.uniform(-reach, reach);
          Placement there = {placed.wrapped(at.place + Vec2{dx, random.uniform(-reach, reach)}), at.turns};
          if (!discs) {
            const double most = std::min(0.25, reach / (2 * std::numbers::pi * placed.shape().reach * radii[k]));
            there.turns += random.uniform(-most, most);
          }
          const Crowding then = crowding(placed, body, there);
          if (lies_free ? then.squares > 0 : then.squares >= here.squares) continue;
          placed.move(body, there.place, there.turns);
          at = there;
          here = then;
        }
      }
      if (overlapping > 0) continue;
      return;
    }
    computation_failed(
        fmt::format("after {} sweeps {}s still overlap by {:.2g} of a radius at a solid fraction of {:.4g}",
                    options.attempts, noun_of(options.shape.kind), deepest,
                    area_of(options.shape, options.radii) / options.box.area()),
        "small random moves find the way apart ever more slowly as the box fills",
        "Ask for less, for more attempts, or use growth");
  });
  Bodies bodies = placed.bodies();
  bodies.radii = options.radii;
  make_grains(options.shape, bodies, options.settling.density, packing);
}

}  // namespace equidem
