// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>

#include "equidem/packing/packing.hpp"

namespace equidem {

/// Bodies in the middle of square cells, row by row.
void fill_by_grid(const PackingOptions& options, GrainPacking& packing) {
  const double count = static_cast<double>(options.radii.size());
  const Vec2 box = options.box.size;
  const double columns = std::ceil(std::sqrt(count * box.x / box.y)), rows = std::ceil(count / columns);
  Bodies bodies;
  for (std::size_t k = 0; k < options.radii.size(); ++k) {
    const double row = std::floor(static_cast<double>(k) / columns), column = static_cast<double>(k) - row * columns;
    bodies.centres.push_back({(column + 0.5) * box.x / columns, (row + 0.5) * box.y / rows});
    bodies.radii.push_back(options.radii[k]);
    if (!options.shape.is_disc()) bodies.turns.push_back(0);
  }
  packing.work = 1;
  make_grains(options.shape, bodies, options.settling.density, packing);
}

}  // namespace equidem
