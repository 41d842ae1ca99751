// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Contact geometry of two parts of bodies, or of a part and a wall, in scenes with ellipses or clumps.
#pragma once

#include "equidem/contact/shapes/ellipse_contact.hpp"
#include "equidem/grains/grain_system.hpp"

namespace equidem {

/// Arms lead from the centres of the bodies to one common point, so that contact forces conserve angular momentum. The
/// point divides the overlap in the ratio of the radii of discs of equal area (discs: r_i/(r_i + r_j)); at a wall it is
/// the point of the grain.
struct PartGeometry {
  double overlap = 0;             ///< m; 0: apart
  Vec2 normal = {};               ///< unit, from i to j
  Vec2 arm_i = {}, arm_j = {};    ///< m
  double sunk_i = 0, sunk_j = 0;  ///< distance from the end of the arm to the surface, m
};

/// Geometry at the start of the step: discs as in geometry_of_grains and geometry_with_wall, ellipses by
/// GrainOptions::EllipseLaw.
/// \param pair stores the normal along which ellipses are apart. Of earlier steps, the result depends only on the last
///        normal of a touching candidate, which a saved state contains.
PartGeometry geometry_of_parts(const GrainSystem& system, const Candidate& candidate, PartPair& pair);

/// The exact contact of two parts of which one is an ellipse.
/// \param normal of the last step if touching, else a direction along which they were apart, or {}: start of the
///        iteration, without effect on the result
/// \return if they are apart, only gap > 0 and a normal along which they are
EllipseContact contact_of_parts(const Ellipse& i, const Ellipse& j, Vec2 branch, bool touching, Vec2 normal);

/// The overlap of any candidate, parts or not, > 0 where it touches.
double overlap_of(const GrainSystem& system, std::size_t candidate);

/// Reference point of the contact of a part with a wall: the centre of a disc, the contact point of an ellipse.
Vec2 viewpoint_on(const GrainSystem& system, std::int32_t grain, std::int32_t part, std::int32_t wall);

/// Sukegawa's test (4.32) with the overlap that it implies: the displacement of j along the normal after which the test
/// fails. By the identity JDG + 1 = c^T S^-1 c, S = P_i + P_j + 2 (P_i # P_j), P = R diag(a², b²) R^T, # the geometric
/// mean, that is the root of a quadratic equation. (The thesis sums the normal relative displacement from the step on
/// in which the test first holds, (4.50).) The normal is not the gradient of this overlap: such contacts do not
/// conserve energy. \return is_contact() where the test holds, else gap > 0 alone
EllipseContact contact_by_enlarged_ellipse(const Ellipse& i, const Ellipse& j, Vec2 branch);

}  // namespace equidem
