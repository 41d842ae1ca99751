// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// From the motion of two bodies to stretch and slip at their contact, and back from contact forces to the bodies.
#pragma once

#include "equidem/assembly/assembly.hpp"
#include "equidem/core/vector.hpp"

namespace equidem {

/// The geometry of one contact: the unit normal n from i to j and the lever arms.
struct ContactFrame {
  Vec2 normal;
  double lever_i = 0;  ///< m
  double lever_j = 0;  ///< m

  [[nodiscard]] Vec2 tangent() const { return perpendicular(normal); }
};

/// Displacement of a disc: translation (m) and rotation (rad, counter-clockwise).
struct DiscMotion {
  Vec2 u;
  double theta = 0;
};

/// Normal stretch (tension positive) and tangential slip of a contact, m.
template <typename Number>
struct DeformationOf {
  Number normal = 0;
  Number tangential = 0;
};
using ContactDeformation = DeformationOf<double>;

/// Normal (tension positive) and tangential force of a contact, N/m: F on i is normal * n + tangential * s, and -F on
/// j.
template <typename Number>
struct ForceOf {
  Number normal = 0;
  Number tangential = 0;
};
using ContactForce = ForceOf<double>;

inline ContactFrame frame_of(const Assembly& assembly, const Contact& contact) {
  const Vec2 l = assembly.branch(contact);
  return {l / norm(l), contact.lever_i, contact.lever_j};
}

/// dn = du . n,  ds = du . s - turn, with du = u_j - u_i and turn = r_i theta_i + r_j theta_j: Abe 1996, eqs. (1)-(3) with
/// r_i = r_j = a. In any precision: residuals need more than a double.
template <typename Number>
DeformationOf<Number> deformation(const ContactFrame& frame, Number du_x, Number du_y, Number turn) {
  const Vec2 n = frame.normal, s = frame.tangent();
  return {du_x * n.x + du_y * n.y, du_x * s.x + du_y * s.y - turn};
}

inline ContactDeformation deformation(const ContactFrame& frame, const DiscMotion& i, const DiscMotion& j) {
  const Vec2 du = j.u - i.u;
  return deformation(frame, du.x, du.y, frame.lever_i * i.theta + frame.lever_j * j.theta);
}

/// The force that disc i feels through the contact; disc j feels its negative.
inline Vec2 force_on_i(const ContactFrame& frame, const ContactForce& f) {
  return f.normal * frame.normal + f.tangential * frame.tangent();
}

}  // namespace equidem
