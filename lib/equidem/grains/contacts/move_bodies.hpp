// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The motion of all bodies in a step.
#pragma once

#include <array>
#include <cstddef>

#include "equidem/grains/grain_system.hpp"

namespace equidem {

/// \param gain,turn change of velocity and of spin by the contacts in the last step
inline PairBody pair_body(const GrainBody& body, const GrainMotion& motion, Vec2 gain, double turn) {
  return {motion.position, motion.velocity, motion.spin * body.radius, motion.velocity + 0.5 * gain,
          (motion.spin + 0.5 * turn) * body.radius};
}

/// Add the torque of the tangential impulses of near pairs.
inline void turn_rims(BodyImpulse& push, const GrainBody& body) {
  push.torque += body.radius * push.rim;
  push.rim = 0;
}

/// Set system.bodies.next[i] = motion(i), the motion after the step, and system.longest_way in the same loop.
template <class Motion>
void move_bodies(GrainSystem& system, const Motion& motion) {
  const GrainMotion* before = system.bodies.motions.data();
  GrainMotion* after = system.bodies.next.data();
  const auto move = [&](std::size_t i, double& longest) {
    after[i] = motion(i);
    const Vec2 way = after[i].position - before[i].position;
    const double square = dot(way, way);
    longest = square > longest || square != square ? square : longest;  // a NaN persists: no number compares as larger
  };
  constexpr std::size_t lanes = 4;  // independent maxima, so that comparisons do not wait for one another
  std::array<double, lanes> longest{};
  const std::size_t count = system.bodies.motions.size(), whole = count - count % lanes;
  for (std::size_t i = 0; i < whole; i += lanes) {
    for (std::size_t k = 0; k < lanes; ++k) move(i + k, longest[k]);
  }
  for (std::size_t i = whole; i < count; ++i) move(i, longest[0]);
  for (std::size_t k = 1; k < lanes; ++k) {
    if (longest[k] > longest[0] || longest[k] != longest[k]) longest[0] = longest[k];
  }
  system.longest_way = longest[0];
}

}  // namespace equidem
