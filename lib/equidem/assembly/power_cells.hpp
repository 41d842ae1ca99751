// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Voronoi cells of equal discs, power cells of unequal ones (Aurenhammer 1987): facets, areas, and the stretches of
/// the sides of a rectangle that the cells take.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "equidem/assembly/assembly.hpp"

namespace equidem {

/// The power diagram of discs, the power of a place x being |x - centre|² - radius².
struct PowerCells {
  std::vector<Contact> neighbours;         ///< pairs of cells that share a facet, ascending by i, then j, then
                                           ///< shift; levers reach to the facet, kept between the two centres
  std::vector<double> facet_lengths;       ///< m, one per pair of neighbours
  std::vector<double> areas;               ///< m², one per disc; 0 where a cell is empty
  std::map<std::string, DiscGroup> sides;  ///< free: left, right, bottom, top with the length that each cell takes
                                           ///< of the side; bottom_left, ... the cell that holds the corner
  bool collinear = false;                  ///< all centres lie on one line
};

/// The box of a free assembly, else the smallest rectangle that holds all discs, m.
Rectangle region_of_cells(const Assembly& assembly);

/// Cells of a periodic assembly, or of a free one in the given rectangle, which must hold all centres: without one in
/// that of the assembly, else in the smallest that holds all discs. Facets shorter than 1e-9 of the distance of the
/// centres are left out: they are corners where more than three cells meet.
///
/// A periodic diagram is that of the cell and of as many images around it as it takes to prove that none further away
/// matters: no power circle of a triangle at the cell reaches beyond the images.
/// \throws Error (bad_input) naming two discs with the same centre; where the period is so narrow
///         that too many images would be needed
PowerCells power_cells(const Assembly& assembly, const std::optional<Rectangle>& domain = {});

/// One of several strips of a sample, of which each belongs to a process of its own; these agree by calls that all
/// make.
struct StripShare {
  std::size_t strip = 0, count = 1;
  std::function<bool(bool)> any;  ///< whether it holds for one of the strips
  /// The numbers of all strips together.
  std::function<std::vector<std::int32_t>(const std::vector<std::int32_t>&)> joined;
};

struct StripCells {
  PowerCells cells;                    ///< neighbours that start in the strip; areas of its discs; all sides
  std::vector<std::int32_t> strips;    ///< per disc: its strip
  std::vector<std::int32_t> contacts;  ///< per disc of this strip: its neighbours
};

/// The cells of one strip: that of the whole assembly alone is held as points, the triangulation is that of the strip.
/// \param domain the rectangle of a free assembly; of a periodic one its cell
/// \throws Error (bad_input) as power_cells
StripCells strip_cells(const Assembly& assembly, const Rectangle& domain, const StripShare& share);

/// The sides of the cells of a free assembly, without its triangulation.
std::map<std::string, DiscGroup> measured_sides(const Assembly& assembly);

}  // namespace equidem
