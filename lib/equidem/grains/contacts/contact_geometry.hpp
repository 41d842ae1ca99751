// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Contact geometry and relative motion of the two bodies of a candidate.
///
/// Contact geometry of two parts of bodies, or of a part and a wall, in scenes with ellipses or clumps.
#pragma once

#include "equidem/geometry/shape_contact.hpp"
#include "equidem/grains/grain_system.hpp"

namespace equidem {

/// Overlap, normal from i to j, levers from the centres to the contact point. The levers of two grains add up to the
/// distance of their centres, so that contact forces conserve angular momentum. The lever at a wall is the radius.
struct ContactGeometry {
  double overlap = 0;
  Vec2 normal;
  double lever_i = 0, lever_j = 0;
};

inline ContactGeometry geometry_of_grains(const GrainBody& bi, const GrainBody& bj, Vec2 branch) {
  const double distance = norm(branch);
  ContactGeometry geometry;
  geometry.overlap = bi.radius + bj.radius - distance;
  geometry.normal = distance > 0 ? branch / distance : Vec2{1, 0};
  const double share = bi.radius / (bi.radius + bj.radius);
  geometry.lever_i = share * distance;
  geometry.lever_j = distance - geometry.lever_i;
  return geometry;
}

/// Geometry at the start of the step.
inline ContactGeometry geometry_of(const GrainSystem& system, const Candidate& candidate) {
  const auto i = static_cast<std::size_t>(candidate.i);
  if (candidate.j >= 0) {
    const auto j = static_cast<std::size_t>(candidate.j);
    return geometry_of_grains(system.bodies.constants[i], system.bodies.constants[j],
                              system.bodies.motions[j].position - system.bodies.motions[i].position);
  }
  const auto w = static_cast<std::size_t>(~candidate.j);
  const GrainBody& body = system.bodies.constants[candidate.i];
  if (candidate.covered) return {-body.radius, {1, 0}, body.radius, 0};  // apart
  const WallContact contact =
      nearest(system.scene.walls[w], system.walls.places[w].displacement, system.bodies.motions[i].position);
  return {body.radius - contact.distance, -contact.normal, body.radius, 0};
}

/// Velocity of j, or of the wall, relative to i.
inline Vec2 relative_velocity(const GrainSystem& system, const Candidate& candidate) {
  const Vec2 other = candidate.j >= 0 ? system.bodies.motions[candidate.j].velocity
                                      : system.walls.places[~candidate.j].acting_velocity;
  return other - system.bodies.motions[candidate.i].velocity;
}

/// Tangential velocity of the surface of j relative to that of i at the contact.
inline double slip_velocity(const GrainSystem& system, const Candidate& candidate, const ContactGeometry& geometry,
                            Vec2 relative) {
  double turning = system.bodies.motions[candidate.i].spin * geometry.lever_i;
  if (candidate.j >= 0) turning += system.bodies.motions[candidate.j].spin * geometry.lever_j;
  return dot(relative, perpendicular(geometry.normal)) - turning;
}

/// The inverse of the tangential mass: 1/m_i + 1/m_j + l_i²/I_i + l_j²/I_j, 1/kg.
inline double inverse_tangential_mass(const GrainSystem& system, const Candidate& candidate,
                                      const ContactGeometry& geometry) {
  const GrainBody& bi = system.bodies.constants[candidate.i];
  double inverse = bi.inverse_mass + geometry.lever_i * geometry.lever_i * bi.inverse_moment;
  if (candidate.j >= 0) {
    const GrainBody& bj = system.bodies.constants[candidate.j];
    inverse += bj.inverse_mass + geometry.lever_j * geometry.lever_j * bj.inverse_moment;
  }
  return inverse;
}

/// Arms lead from the centres of the bodies to one common point, so that contact forces conserve angular momentum. The
/// point divides the overlap in the ratio of the radii of discs of equal area (discs: r_i/(r_i + r_j)); at a wall it is
/// the point of the grain.
struct PartGeometry {
  double overlap = 0;             ///< m; 0: apart, if no contact has cohesion; else negative by the gap
  Vec2 normal = {};               ///< unit, from i to j
  Vec2 arm_i = {}, arm_j = {};    ///< m
  double sunk_i = 0, sunk_j = 0;  ///< distance from the end of the arm to the surface, m
  double across_i = 0;            ///< at walls: arm_i x normal, m; of discs exactly 0
};

/// Geometry at the start of the step: discs as in geometry_of_grains, ellipses by GrainOptions::EllipseLaw.
/// \param touching,normal as in contact_of_parts: the result depends only on the last normal of a touching pair, which
///        a saved state contains
PartGeometry geometry_of_parts(const GrainSystem& system, const Partners& of, bool touching, Vec2 normal);

/// \param number of the part, in scenes of discs of the body
/// \param normal of the last step where it touched, else {}
PartGeometry geometry_with_wall(const GrainSystem& system, std::int32_t number, std::size_t wall, Vec2 normal);

/// The exact contact of two parts of which one is an ellipse.
/// \param normal of the last step if touching, else a direction along which they were apart, or {}: start of the
///        iteration, without effect on the result
/// \param range beyond which they are apart, m
/// \return if they are apart, only gap > range and a normal along which they are
EllipseContact contact_of_parts(const Ellipse& i, const Ellipse& j, Vec2 branch, bool touching, Vec2 normal,
                                double range = 0);

/// Reference point of the contact of a part with a wall: the centre of a disc, the contact point of an ellipse.
Vec2 viewpoint_on(const GrainSystem& system, std::int32_t grain, std::int32_t part, std::int32_t wall);

/// Sukegawa's test (4.32) with the overlap that it implies: the displacement of j along the normal after which the test
/// fails. By the identity JDG + 1 = c^T S^-1 c, S = P_i + P_j + 2 (P_i # P_j), P = R diag(a², b²) R^T, # the geometric
/// mean, that is the root of a quadratic equation. (The thesis sums the normal relative displacement from the step on
/// in which the test first holds, (4.50).) The normal is not the gradient of this overlap: such contacts do not
/// conserve energy. \return is_contact() where the test holds, else gap > 0 alone
EllipseContact contact_by_enlarged_ellipse(const Ellipse& i, const Ellipse& j, Vec2 branch);

}  // namespace equidem
