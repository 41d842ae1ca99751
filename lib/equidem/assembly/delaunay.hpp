// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Random assemblies: a point process, its Delaunay (or, for discs of different radii, regular)
/// triangulation, whose edges are the contacts.
#pragma once

#include <cstdint>
#include <string>

#include "equidem/assembly/assembly.hpp"

namespace equidem {

enum class PointProcess {
  poisson_disc,         ///< random points no closer than a distance (blue noise)
  perturbed_hexagonal,  ///< hexagonal lattice, each point moved at random by at most `disorder` times the
                        ///< spacing
  uniform,              ///< independent uniform points (Poisson process conditioned on its count)
};

/// "poisson_disc" | "perturbed_hexagonal" | "random". \throws Error (bad_input) naming the choices
PointProcess point_process_from(const std::string& name);

/// Radii of the discs: equal, or uniform in [smallest, largest]; they weight the regular triangulation.
struct RadiusDistribution {
  double smallest = 0.005;  ///< m, > 0
  double largest = 0.005;   ///< m, >= smallest
};

struct DelaunayOptions {
  std::int64_t discs = 10000;  ///< wanted count, >= 3; perturbed_hexagonal and poisson_disc come near it, the
                               ///< report says how near
  PointProcess points = PointProcess::poisson_disc;
  double disorder = 0.1;  ///< perturbed_hexagonal: in [0, 0.5)
  std::uint64_t seed = 1;
  RadiusDistribution radii;
  double aspect = 1;  ///< width over height of the rectangle, > 0
  bool periodic = false;
};

/// The mean spacing of neighbours is the mean diameter. Contacts are the edges of the triangulation, each at
/// the midpoint of its branch (equal radii) or at the radical axis; facet lengths are those of the Voronoi
/// (power) cells, clipped to the rectangle where free. Groups of a free assembly: the discs whose cells touch
/// a side or hold a corner, with the length of the side in their cell. Same options, same assembly, on every
/// machine. \throws Error (bad_input) on options out of range
Assembly delaunay_assembly(const DelaunayOptions& options);

/// Contacts and cells by (regular) triangulation of given discs; `assembly` brings centres, radii and period.
/// \throws Error (bad_input) on duplicate centres, fewer than three discs or collinear centres (named)
void triangulate(Assembly& assembly);

/// Voronoi (power) cell areas of given discs whose contacts are already known, and facet lengths of those
/// contacts that are edges of the triangulation (0 for the others).
void measure_cells(Assembly& assembly);

}  // namespace equidem
