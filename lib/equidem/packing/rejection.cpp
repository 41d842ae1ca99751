// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "equidem/core/error.hpp"
#include "equidem/core/progress.hpp"
#include "equidem/core/random.hpp"
#include "equidem/core/text.hpp"
#include "equidem/packing/packing.hpp"
#include "equidem/packing/placed_discs.hpp"

namespace equidem {

/// Random sequential adsorption. Equal discs approach 0.5471 as attempts^(-1/2) (Feder 1980).
void fill_by_rejection(const PackingOptions& options, DiscPacking& packing) {
  Random random(options.seed);
  std::vector<double> radii = options.radii;
  // Large ones first find room that small ones leave; where not all need to fit, in the order given: it decides who stays.
  if (!options.as_dense_as_possible) std::sort(radii.begin(), radii.end(), std::greater<>());
  PlacedDiscs placed(options.box, *std::max_element(radii.begin(), radii.end()));
  Progress progress("placing");
  for (std::size_t k = 0; k < radii.size(); ++k) {
    if (k % 64 == 0) progress.update(static_cast<double>(k) / static_cast<double>(radii.size()));
    const double margin = options.box.periodic() ? 0 : radii[k];
    bool found = false;
    for (std::int64_t attempt = 0; attempt < options.attempts && !found; ++attempt) {
      ++packing.work;
      const double x = random.uniform(margin, options.box.size.x - margin);
      const Vec2 place = {x, random.uniform(margin, options.box.size.y - margin)};
      found = placed.has_room(place, radii[k]);
      if (found) placed.add(place, radii[k]);
    }
    if (found) continue;
    packing.complete = false;
    if (options.as_dense_as_possible) continue;
    computation_failed(
        format("{} of {} discs found a place, {:.4g} of the box", k, radii.size(),
               area_of_discs(placed.radii()) / options.box.area()),
        format(
            "for the next one {} attempts were all in vain; equal discs thrown at random never cover more than 0.547",
            options.attempts),
        "Ask for less, for more attempts, or use insertion or growth");
  }
  packing.centres = placed.centres();
  packing.radii = placed.radii();
}

}  // namespace equidem
