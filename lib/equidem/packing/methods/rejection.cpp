// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "equidem/core/error.hpp"
#include "equidem/core/progress.hpp"
#include "equidem/core/random.hpp"
#include "equidem/core/text.hpp"
#include "equidem/packing/packing.hpp"
#include "equidem/packing/placed_bodies.hpp"

namespace equidem {

/// Random sequential adsorption. Equal discs approach 0.5471 as attempts^(-1/2) (Feder 1980).
void fill_by_rejection(const PackingOptions& options, GrainPacking& packing) {
  Random random(options.seed);
  std::vector<double> radii = options.radii;
  // Large bodies first, since they find less room later; where not all need to fit, the order given decides which stay.
  if (!options.as_dense_as_possible) std::sort(radii.begin(), radii.end(), std::greater<>());
  PlacedBodies placed(options.box, unit_body_of(options.shape), radii);
  Progress progress("placing");
  keep_failure(packing, [&] {
    for (std::size_t k = 0; k < radii.size(); ++k) {
      if (k % 64 == 0) progress.update(static_cast<double>(k) / static_cast<double>(radii.size()));
      bool found = false;
      for (std::int64_t attempt = 0; attempt < options.attempts && !found; ++attempt) {
        ++packing.work;
        if (packing.work % 4096 == 0) stop_if_interrupted();
        const Placement there = placement_at_random(options, placed.shape(), radii[k], random);
        found = placed.has_room(there.place, radii[k], there.turns);
        if (found) placed.add(there.place, radii[k], there.turns);
      }
      if (found) continue;
      packing.complete = false;
      if (options.as_dense_as_possible) continue;
      computation_failed(
          fmt::format("{} of {} {}s found a place, {:.4g} of the box", k, radii.size(), noun_of(options.shape.kind),
                      area_of(options.shape, placed.bodies().radii) / options.box.area()),
          fmt::format(
              "{} attempts to place the next one failed; equal discs placed at random never cover more than 0.547",
              options.attempts),
          "Ask for less, for more attempts, or use growth");
    }
  });
  make_grains(options.shape, placed.bodies(), options.settling.density, packing);
}

}  // namespace equidem
