// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <utility>

#include "equidem/core/progress.hpp"
#include "equidem/core/random.hpp"
#include "equidem/packing/overlaps.hpp"
#include "equidem/packing/packing.hpp"

namespace equidem {
namespace {

/// Staggered rows, wide enough for the largest disc; each disc shifted at random within its room.
std::vector<Vec2> staggered_grid(std::span<const double> radii, double width, Random& random) {
  const double largest = *std::max_element(radii.begin(), radii.end());
  constexpr double room = 1.1;
  const double wanted = 2 * room * largest;
  const auto columns = std::max<std::size_t>(1, static_cast<std::size_t>((width - wanted / 2) / wanted));
  // Rows are shifted by half a spacing to and fro.
  const bool stagger = width >= 1.5 * wanted;
  const double spacing = width / (static_cast<double>(columns) + (stagger ? 0.5 : 0));
  std::vector<Vec2> places;
  for (std::size_t k = 0; k < radii.size(); ++k) {
    const std::size_t row = k / columns, column = k % columns;
    const double shift = stagger && row % 2 == 1 ? 1.0 : 0.5;
    const double slack = wanted / 2 - radii[k];
    const double dx = random.uniform(-slack, slack);
    places.push_back({(static_cast<double>(column) + shift) * spacing + dx,
                      (static_cast<double>(row) + 0.5) * wanted + random.uniform(-slack, slack)});
  }
  return places;
}

/// Down without inertia and friction: contacts soft at first, so that forces are felt far, then as hard as they are.
void relax_down(const PackingOptions& options, std::vector<Vec2>& centres, std::int64_t& work) {
  double mean = 0, squares = 0;
  for (const double radius : options.radii) mean += radius, squares += radius * radius;
  mean /= static_cast<double>(options.radii.size());
  const double mean_mass =
      options.settling.density * area_of_discs(options.radii) / static_cast<double>(options.radii.size());
  const double hard = mean_mass * options.settling.gravity / (options.settling.springs.kN * mean);
  PairFinder finder;
  Progress progress("relaxing");
  constexpr double softest = 1e-4, factor = 10;
  for (double weight = std::max(softest, hard);; weight = std::max(weight / factor, hard)) {
    const bool last = weight <= hard;
    const auto report =
        push_apart(options.box, options.radii,
                   {.unbalanced = last ? 1e-8 : 1e-3, .weight = {0, -weight}, .most = 200000}, finder, centres);
    work += report.evaluations;
    progress.update(last ? 1 : 0.5);
    if (last) return;
  }
}

}  // namespace

void fill_by_falling(const PackingOptions& options, DiscPacking& packing) {
  Random random(options.seed);
  std::vector<Vec2> centres = staggered_grid(options.radii, options.box.size.x, random);
  if (options.settling.relax_first) relax_down(options, centres, packing.work);
  SettledDiscs settled = settle(centres, options.radii, options.box.size.x, options.settling);
  packing.work += settled.report.steps;
  double top = 0;
  for (const Grain& grain : settled.grains) {
    packing.centres.push_back(grain.position);
    packing.radii.push_back(grain.radius);
    top = std::max(top, grain.position.y + grain.radius);
  }
  packing.box.size.y = top;
  packing.grains = std::move(settled.grains);
  packing.contacts = std::move(settled.contacts);
  packing.settling = settled.report;
}

}  // namespace equidem
