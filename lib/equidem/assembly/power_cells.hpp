// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Voronoi cells of equal discs, power cells of unequal ones (Aurenhammer 1987): facets, areas, and the stretches of
/// the sides of a rectangle that the cells take.
#pragma once

#include <array>
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
  std::map<std::string, DiscGroup> sides;  ///< free: those of measured_sides with the length that each cell takes of
                                           ///< the side; bottom_left, ... the cell that holds the corner
  bool collinear = false;                  ///< all centres lie on one line
};

/// The region that the cells of a free assembly fill: its box, else the rectangle of least area that holds all discs
/// (least_rectangle.hpp), which turns with them.
TurnedRectangle region_of_cells(const Assembly& assembly);

/// \throws Error (bad_input) naming a disc with its centre outside the region of the cells
void check_inside(const Assembly& assembly, const TurnedRectangle& region);

/// Cells of a periodic assembly, or of a free one in the given rectangle, which must hold all centres: without one in
/// its region. They fill it to round-off. Facets shorter than 1e-9 of the distance of the
/// centres are left out: they are corners where more than three cells meet.
///
/// A periodic diagram is that of the cell and of as many images around it as it takes to prove that none further away
/// matters: no power circle of a triangle at the cell reaches beyond the images.
/// \throws Error (bad_input) naming two discs with the same centre; where the period is so narrow
///         that too many images would be needed; (computation_failed) where round-off has lost part of the rectangle
PowerCells power_cells(const Assembly& assembly, const std::optional<TurnedRectangle>& domain = {});

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

/// The groups left, right, bottom, top, bottom_left, ... of a free assembly, without its triangulation: the discs of
/// which cells reach the sides of its region, or, where this is turned, of the upright rectangle that holds all discs.
std::map<std::string, DiscGroup> measured_sides(const Assembly& assembly);

/// A side of the region of a free assembly, with the discs of which cells reach it.
struct RegionSide {
  Vec2 outward;  ///< unit
  DiscGroup discs;
};
/// Counter-clockwise from its lower side.
std::array<RegionSide, 4> region_sides(const Assembly& assembly);

}  // namespace equidem
