// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Kinematics of a contact: stretch and slip from the motion of two bodies, and forces on the bodies from the contact
/// force.
#pragma once

#include <cstddef>

#include "equidem/assembly/assembly.hpp"
#include "equidem/core/vector.hpp"

namespace equidem {

/// The geometry of one contact: the unit normal n from i to j and the arms of the contact point, lever n + offset s
/// from the centre of i and its negative from that of j (ContactArms).
struct ContactFrame {
  Vec2 normal;
  double lever_i = 0;   ///< m
  double lever_j = 0;   ///< m
  double offset_i = 0;  ///< m; zero on the line of centres
  double offset_j = 0;  ///< m

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

/// Frame of a contact of the assembly, by its number.
inline ContactFrame frame_of(const Assembly& assembly, std::size_t contact) {
  const Contact& c = assembly.contacts[contact];
  if (!assembly.contact_arms.empty()) {
    const ContactArms& arms = assembly.contact_arms[contact];
    return {arms.normal, c.lever_i, c.lever_j, arms.offset_i, arms.offset_j};
  }
  const Vec2 l = assembly.branch(c);
  return {l / norm(l), c.lever_i, c.lever_j};
}

/// Whether a rotation deforms a contact with the tangential spring kT, if it moves the contact point by `lever` along
/// and by `offset` across the contact.
constexpr bool turns_against(double lever, double offset, double kT) {
  return offset != 0 || (kT != 0 && lever != 0);
}

/// dn = du . n + opening,  ds = du . s - turn, with du = u_j - u_i, turn = r_i theta_i + r_j theta_j and opening = o_i
/// theta_i + o_j theta_j of levers r and offsets o: Abe 1996, eqs. (1)-(3) with r_i = r_j = a, o_i = o_j = 0. In any
/// precision: residuals need more than a double.
template <typename Number>
DeformationOf<Number> deformation(const ContactFrame& frame, Number du_x, Number du_y, Number turn,
                                  Number opening = 0) {
  const Vec2 n = frame.normal, s = frame.tangent();
  return {du_x * n.x + du_y * n.y + opening, du_x * s.x + du_y * s.y - turn};
}

inline ContactDeformation deformation(const ContactFrame& frame, const DiscMotion& i, const DiscMotion& j) {
  const Vec2 du = j.u - i.u;
  return deformation(frame, du.x, du.y, frame.lever_i * i.theta + frame.lever_j * j.theta,
                     frame.offset_i * i.theta + frame.offset_j * j.theta);
}

/// Stretch and slip where the branch of the contact deforms by a displacement gradient, and no body turns.
inline ContactDeformation affine_deformation(const ContactFrame& frame, Vec2 branch, const Tensor2& gradient) {
  const Vec2 du = gradient * branch;
  return deformation(frame, du.x, du.y, 0.0);
}

/// The contact force on disc i; its negative acts on disc j.
inline Vec2 force_on_i(const ContactFrame& frame, const ContactForce& f) {
  return f.normal * frame.normal + f.tangential * frame.tangent();
}

/// The moments that the contact exerts on i and on j, about their centres, N.
template <typename Number>
Number moment_on_i(const ContactFrame& frame, const ForceOf<Number>& f) {
  const Number of_shear = frame.lever_i * f.tangential;
  return frame.offset_i == 0 ? of_shear : of_shear - frame.offset_i * f.normal;
}
template <typename Number>
Number moment_on_j(const ContactFrame& frame, const ForceOf<Number>& f) {
  const Number of_shear = frame.lever_j * f.tangential;
  return frame.offset_j == 0 ? of_shear : of_shear - frame.offset_j * f.normal;
}

/// Vectors from the centre of i to the contact point, and from there to the centre of j, m.
inline Vec2 arm_of_i(const ContactFrame& frame) {
  return frame.lever_i * frame.normal + frame.offset_i * frame.tangent();
}
inline Vec2 arm_to_j(const ContactFrame& frame) {
  return frame.lever_j * frame.normal + frame.offset_j * frame.tangent();
}

}  // namespace equidem
