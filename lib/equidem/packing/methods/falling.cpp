// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <utility>

#include "equidem/core/random.hpp"
#include "equidem/packing/overlaps.hpp"
#include "equidem/packing/packing.hpp"

namespace equidem {
namespace {

/// Staggered rows, wide enough for the circle round the largest body; each shifted at random within its room.
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

Bodies bodies_above(const PackingOptions& options, const UnitBody& shape) {
  Random random(options.seed);
  std::vector<double> reaches;
  for (const double radius : options.radii) reaches.push_back(shape.reach * radius);
  Bodies bodies{staggered_grid(reaches, options.box.size.x, random), options.radii, {}};
  if (!options.shape.is_disc())
    for (std::size_t k = 0; k < bodies.size(); ++k) bodies.turns.push_back(random.uniform());
  return bodies;
}

/// The bodies as grains of the packing, and the scene in which they fall.
GrainScene scene_of(const PackingOptions& options, const Bodies& bodies, GrainPacking& packing) {
  make_grains(options.shape, bodies, options.settling.density, packing);
  GrainScene scene = scene_of_box(options.box.size.x, options.settling);
  scene.grains = packing.grains;
  scene.clumps = packing.clumps;
  scene.bonds = packing.bonds;
  return scene;
}

}  // namespace

void fill_by_falling(const PackingOptions& options, GrainPacking& packing) {
  const UnitBody shape = unit_body_of(options.shape);
  GrainScene scene = scene_of(options, bodies_above(options, shape), packing);
  SettledBodies settled = settle(std::move(scene), options.settling);
  packing.work += settled.report.steps;
  packing.grains = std::move(settled.grains);
  packing.contacts = std::move(settled.contacts);
  packing.bonds = std::move(settled.bonds);
  packing.settling = settled.report;
  keep_failure(packing, [&] {
    if (settled.failure) throw *settled.failure;
  });
  double top = 0;
  for (const Grain& grain : packing.grains)
    top = std::max(top, grain.position.y + reach_along(outline_of(grain, packing.clumps), {0, 1}));
  packing.box.size.y = top;
}

}  // namespace equidem
