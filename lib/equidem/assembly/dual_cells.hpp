// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Facets and areas of power cells from the edges of a triangulation.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "equidem/assembly/power_cells.hpp"
#include "equidem/assembly/sites.hpp"
#include "equidem/assembly/strips.hpp"
#include "equidem/assembly/triangulation.hpp"

namespace equidem {

/// Cells of the edges of a triangulation, without sides.
struct DualCells {
  PowerCells cells;
  std::vector<std::int32_t> cut;       ///< discs with a facet that the rectangle cuts, some of them repeated
  std::vector<std::int32_t> contacts;  ///< of a chosen strip: neighbours of each of its discs
};

/// Neighbours, facets, and the part of the areas that lies between centres and facets: half of lever times length on
/// either side, the lever negative where the facet lies behind the centre: they fill the rectangle together with the
/// parts between centres and sides. None where a facet is not certain. Where a
/// strip is chosen: neighbours that start in it, and areas of its discs.
/// \param domain the rectangle of a free assembly
std::optional<DualCells> cells_between(const Sites& sites, std::span<const TriangulationEdge> edges,
                                       const Strips& strips, const std::optional<TurnedRectangle>& domain,
                                       std::size_t discs);

}  // namespace equidem
