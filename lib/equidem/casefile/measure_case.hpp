// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// [measures]: what is read off bodies in a box while they move.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "equidem/casefile/keys.hpp"
#include "equidem/grains/scene/clipped_area.hpp"
#include "equidem/material/inertia.hpp"

namespace equidem {

struct MeasureCase {
  std::optional<Region>
      region;  ///< of the void ratio, m, where the box stands at the start; none: measured_region at each moment
  std::size_t columns = 0;     ///< of the surface; 0: two largest diameters wide
  double thrown_gap = 1;       ///< mean diameters
  std::optional<double> cell;  ///< width of the cells of the fields, m; none: no fields
};

/// The keys of [measures].
std::vector<KeySpec> measure_keys();

/// \param table [measures], seen by check_and_complete
/// \throws Error (bad_input) with line and key: a region without area, spheres
MeasureCase read_measures(const TomlValue& table, Body body);

}  // namespace equidem
