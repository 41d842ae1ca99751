// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// How two parts of bodies, or a part and a wall, stand to each other in scenes with ellipses or clumps.
#pragma once

#include "equidem/contact/shapes/ellipse_contact.hpp"
#include "equidem/grains/grain_system.hpp"

namespace equidem {

/// Arms go from the centres of the bodies to one common point, so that contact forces keep the angular momentum: within
/// the overlap, which the parts share as the radii of discs of their areas (of discs: (r_i/(r_i + r_j))); on a wall the
/// point of the grain.
struct PartGeometry {
  double overlap = 0;             ///< m; 0: apart
  Vec2 normal = {};               ///< unit, from i to j
  Vec2 arm_i = {}, arm_j = {};    ///< m
  double sunk_i = 0, sunk_j = 0;  ///< what of the overlap arms lack to the surface, m
};

/// Discs as geometry_of_grains and geometry_with_wall; ellipses by the options' law. As the bodies stand at the start
/// of the step.
/// \param pair remembers the normal along which ellipses are apart. The result depends on the candidate's last normal,
///         which a saved state
///        holds, where it was touching, and on nothing else of the past.
PartGeometry geometry_of_parts(const GrainSystem& system, const Candidate& candidate, PartPair& pair);

/// The exact contact of two parts of which one is an ellipse.
/// \param normal of the last step where it was touching, else a direction along which they were apart, or {}: saves
///         time and changes nothing
/// \return where they are apart gap > 0 alone and a normal along which they are
EllipseContact contact_of_parts(const Ellipse& i, const Ellipse& j, Vec2 branch, bool touching, Vec2 normal);

/// The overlap of any candidate, parts or not, > 0 where it touches.
double overlap_of(const GrainSystem& system, std::size_t candidate);

/// The point from which the contact of a part with a wall is seen: the centre of a disc, the contact point of an
/// ellipse.
Vec2 viewpoint_on(const GrainSystem& system, std::int32_t grain, std::int32_t part, std::int32_t wall);

/// Sukegawa's test (4.32) with the overlap that it implies: as far as j would have to move along the normal until it
/// says apart. By the identity JDG + 1 = c^T S^-1 c, S = P_i + P_j + 2 (P_i # P_j), P = R diag(a², b²) R^T, # the
/// geometric mean, that is the root of a quadratic equation. (The thesis sums the normal relative displacement from the
/// step on in which the test first holds, (4.50).) The normal is not the gradient of this overlap: such contacts do not
/// keep the energy. \return is_contact() where the test holds, else gap > 0 alone
EllipseContact contact_by_enlarged_ellipse(const Ellipse& i, const Ellipse& j, Vec2 branch,
                                           GrainOptions::EllipseLaw law);

}  // namespace equidem
