// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The packings of Sukegawa (2010), section 2.7, side by side; and ellipses that fall under the contact tests of
/// section 4.2.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "equidem/grains/grain_simulation.hpp"

namespace equidem::sukegawa2010 {

/// One way to pack the same discs. NaN: not measured.
struct PackedDiscs {
  std::string way;
  std::int64_t discs = 0;
  double solid_fraction = 0;  ///< away from walls and surface
  double coordination = 0;    ///< contacts per disc, those with walls included
  double held = 0;            ///< the same without rattlers
  double rattlers = 0;        ///< share of the discs
  double overlap = 0;         ///< the largest, over the smaller radius
  double moved = 0;           ///< by the last stage of a pipeline: mean distance over the mean radius
  double seconds = 0;         ///< of computing, all stages
};

/// The five methods of section 2.7, local moves from a grid too, and the three pipelines that the section describes:
/// rejection, growth, gravity; fall, relieve of strain; fall, removal of a part.
std::vector<PackedDiscs> pack_every_way(bool quick);

/// Ellipses that fall into a box under one contact test.
struct FallenEllipses {
  GrainOptions::EllipseLaw law = GrainOptions::EllipseLaw::exact;
  std::size_t ellipses = 0;
  bool at_rest = false;
  double time = 0;           ///< s of motion until rest, or until it stopped
  double overlap = 0;        ///< the largest there is, by the exact contact, over the radius of the disc of equal area
  double overlapping = 0;    ///< pairs that overlap by more than a hundredth of that radius, per ellipse
  double void_ratio = 0;     ///< between the walls, below the mean surface
  std::string stopped = {};  ///< why the motion could not go on
  double seconds = 0;        ///< of computing
};

/// Exact contacts, (4.1)-(4.49) with the quadrants of the angles corrected, and as printed.
std::vector<FallenEllipses> drop_ellipses(bool quick);

std::string report_of(const std::vector<PackedDiscs>& packings);
std::string report_of(const std::vector<FallenEllipses>& boxes);

}  // namespace equidem::sukegawa2010
