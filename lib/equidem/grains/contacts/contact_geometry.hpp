// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Contact geometry and relative motion of the two bodies of a candidate.
#pragma once

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

/// \param position of grain i
inline ContactGeometry geometry_with_wall(const GrainBody& bi, const Wall& wall, Vec2 displacement, Vec2 position) {
  const WallContact contact = nearest(wall, displacement, position);
  return {bi.radius - contact.distance, -contact.normal, bi.radius, 0};
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
  const GrainBody& body = system.bodies.constants[static_cast<std::size_t>(candidate.i)];
  if (candidate.covered) return {-body.radius, {1, 0}, body.radius, 0};  // apart
  return geometry_with_wall(system.bodies.constants[i], system.scene.walls[w], system.walls.places[w].displacement,
                            system.bodies.motions[i].position);
}

/// Velocity of j, or of the wall, relative to i.
inline Vec2 relative_velocity(const GrainSystem& system, const Candidate& candidate) {
  const Vec2 other = candidate.j >= 0 ? system.bodies.motions[static_cast<std::size_t>(candidate.j)].velocity
                                      : system.walls.places[static_cast<std::size_t>(~candidate.j)].acting_velocity;
  return other - system.bodies.motions[static_cast<std::size_t>(candidate.i)].velocity;
}

/// Tangential velocity of the surface of j relative to that of i at the contact.
inline double slip_velocity(const GrainSystem& system, const Candidate& candidate, const ContactGeometry& geometry,
                            Vec2 relative) {
  double turning = system.bodies.motions[static_cast<std::size_t>(candidate.i)].spin * geometry.lever_i;
  if (candidate.j >= 0) turning += system.bodies.motions[static_cast<std::size_t>(candidate.j)].spin * geometry.lever_j;
  return dot(relative, perpendicular(geometry.normal)) - turning;
}

/// The inverse of the tangential mass: 1/m_i + 1/m_j + l_i²/I_i + l_j²/I_j, 1/kg.
inline double inverse_tangential_mass(const GrainSystem& system, const Candidate& candidate,
                                      const ContactGeometry& geometry) {
  const GrainBody& bi = system.bodies.constants[static_cast<std::size_t>(candidate.i)];
  double inverse = bi.inverse_mass + geometry.lever_i * geometry.lever_i * bi.inverse_moment;
  if (candidate.j >= 0) {
    const GrainBody& bj = system.bodies.constants[static_cast<std::size_t>(system.body_of(candidate.j))];
    inverse += bj.inverse_mass + geometry.lever_j * geometry.lever_j * bj.inverse_moment;
  }
  return inverse;
}

}  // namespace equidem
