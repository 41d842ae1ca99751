// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// How the two bodies of a candidate stand to each other.
#pragma once

#include "equidem/grains/grain_system.hpp"

namespace equidem {

/// Overlap, normal from i to j, levers from the centres to the contact point. The levers of two grains add up to the
/// distance of their centres: contact forces keep the angular momentum. That against a wall is the radius.
struct Meeting {
  double overlap = 0;
  Vec2 normal;
  double lever_i = 0, lever_j = 0;
};

inline Meeting meeting_of_grains(const GrainBody& bi, const GrainBody& bj, Vec2 branch) {
  const double distance = norm(branch);
  Meeting meeting;
  meeting.overlap = bi.radius + bj.radius - distance;
  meeting.normal = distance > 0 ? branch / distance : Vec2{1, 0};
  const double share = bi.radius / (bi.radius + bj.radius);
  meeting.lever_i = share * distance;
  meeting.lever_j = distance - meeting.lever_i;
  return meeting;
}

/// \param position of grain i
inline Meeting meeting_with_wall(const GrainBody& bi, const Wall& wall, Vec2 displacement, Vec2 position) {
  const WallContact contact = nearest(wall, displacement, position);
  return {bi.radius - contact.distance, -contact.normal, bi.radius, 0};
}

/// As the bodies stand at the start of the step.
inline Meeting meeting_of(const GrainSystem& system, const Candidate& candidate) {
  const auto i = static_cast<std::size_t>(candidate.i);
  if (candidate.j >= 0) {
    const auto j = static_cast<std::size_t>(candidate.j);
    return meeting_of_grains(system.bodies[i], system.bodies[j],
                             system.motions[j].position - system.motions[i].position);
  }
  const auto w = static_cast<std::size_t>(~candidate.j);
  const GrainBody& body = system.bodies[static_cast<std::size_t>(candidate.i)];
  if (candidate.covered) return {-body.radius, {1, 0}, body.radius, 0};  // apart
  return meeting_with_wall(system.bodies[i], system.scene.walls[w], system.walls[w].displacement,
                           system.motions[i].position);
}

/// Velocity of j, or of the wall, over that of i.
inline Vec2 relative_velocity(const GrainSystem& system, const Candidate& candidate) {
  const Vec2 other = candidate.j >= 0 ? system.motions[static_cast<std::size_t>(candidate.j)].velocity
                                      : system.walls[static_cast<std::size_t>(~candidate.j)].acting_velocity;
  return other - system.motions[static_cast<std::size_t>(candidate.i)].velocity;
}

/// Velocity of the surface of j over that of i at the contact, along the tangent.
inline double slip_velocity(const GrainSystem& system, const Candidate& candidate, const Meeting& meeting,
                            Vec2 relative) {
  double turning = system.motions[static_cast<std::size_t>(candidate.i)].spin * meeting.lever_i;
  if (candidate.j >= 0) turning += system.motions[static_cast<std::size_t>(candidate.j)].spin * meeting.lever_j;
  return dot(relative, perpendicular(meeting.normal)) - turning;
}

/// 1/(1/m_i + 1/m_j + l_i²/I_i + l_j²/I_j).
inline double tangential_mass(const GrainSystem& system, const Candidate& candidate, const Meeting& meeting) {
  const GrainBody& bi = system.bodies[static_cast<std::size_t>(candidate.i)];
  double inverse = bi.inverse_mass + meeting.lever_i * meeting.lever_i * bi.inverse_moment;
  if (candidate.j >= 0) {
    const GrainBody& bj = system.bodies[static_cast<std::size_t>(candidate.j)];
    inverse += bj.inverse_mass + meeting.lever_j * meeting.lever_j * bj.inverse_moment;
  }
  return 1 / inverse;
}

}  // namespace equidem
