// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Random assemblies: a point process, its Delaunay (or, for discs of different radii, regular) triangulation, whose
/// edges are the contacts.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/assembly/point_process.hpp"
#include "equidem/assembly/power_cells.hpp"

namespace equidem {

/// Radii of the discs: equal, or uniform in [smallest, largest]; they weight the regular triangulation.
struct RadiusDistribution {
  double smallest = 0.005;  ///< m, > 0
  double largest = 0.005;   ///< m, >= smallest
};

struct DelaunayOptions {
  std::int64_t discs = 10000;  ///< wanted count, >= 3 (>= 1 where periodic); all processes come near it:
                               ///< assembly.size() is the number reached
  PointProcess points = PointProcess::poisson_disc;
  double disorder = 0.1;  ///< perturbed_hexagonal: in [0, 0.5)
  std::uint64_t seed = 1;
  RadiusDistribution radii = {};
  double aspect = 1;  ///< width over height of the rectangle, in [1e-3, 1e3]; perturbed_hexagonal comes near it
  bool periodic = false;
  /// Width and height of the rectangle, m, instead of the aspect; the points are stretched to it, so that their spacing
  /// follows from it and from the number of discs, and not from the radii.
  std::optional<Vec2> box = {};
};

/// The number of discs for which a box has 2 sqrt3 a² for each, a = (smallest + largest)/2, so that the mean spacing of
/// neighbours is the mean diameter.
/// \throws Error (bad_input) where it is not 1 to 1e9
std::int64_t discs_that_fill(Vec2 box, const RadiusDistribution& radii);

/// Without a box the mean spacing of neighbours is the mean diameter: the rectangle, from the origin to its upper right
/// corner, has 2 sqrt3 a² for each disc, a = (smallest + largest)/2. Contacts are the edges of the triangulation, each
/// at the midpoint of its branch (equal radii) or at the radical axis, kept between the two centres; facet lengths are
/// those of the Voronoi (power) cells, clipped to the rectangle where free. An edge whose facet is a single point or
/// lies outside the rectangle is no contact. Discs that fewer than two contacts would hold are left out: one whose
/// power cell its neighbours have taken, one in a corner with a single neighbour. Discs are numbered along a Hilbert
/// curve. Groups of a free assembly: the discs whose cells touch a side or hold a corner, with the length of the side
/// in their cell. Same options, same assembly, on every machine. \throws Error (bad_input) on options out of range
Assembly delaunay_assembly(const DelaunayOptions& options);

/// The part of one process in an assembly that delaunay_assembly makes: all discs, and the network of one strip.
struct DelaunayStrip {
  Assembly assembly;  ///< contacts that start in the strip; cells of its discs, of others parts; all sides
  std::vector<std::int32_t> strips;  ///< per disc: its strip
};

/// All processes call it, each for a strip of its own.
/// \throws Error (bad_input) as delaunay_assembly
DelaunayStrip delaunay_strip(const DelaunayOptions& options, const StripShare& share);

/// Contacts, facets, cells and, where free, sides by (regular) triangulation of given discs; `assembly` brings
/// centres, radii, period and box. Cells of a free assembly fill its region, which becomes its box. Contacts and cells
/// are replaced; groups are added where there is none of that name.
/// \throws Error (bad_input) on duplicate centres, and where free on fewer than three discs or collinear centres
///         (named)
void triangulate(Assembly& assembly);

/// Voronoi (power) cell areas of given discs whose contacts are already known, and facet lengths of those contacts
/// that are edges of the triangulation (0 for the others); where free, also the box, if there is none, and the groups
/// of sides and corners, where there is none of that name. Any number of discs, also on one line.
/// \throws Error (bad_input) on duplicate centres (named)
void measure_cells(Assembly& assembly);

/// Measure of areas, facets and, where free, groups of sides what a file does not give: triangulating takes longer than
/// reading.
/// \throws Error (bad_input) as measure_cells, and where the areas given do not add up to the box or the periodic cell
void measure_missing_cells(Assembly& assembly);

}  // namespace equidem
