// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// How the energy of a contact changes with the places and radii of its discs while their motions stay.
///
/// Under a change dl of the branch vector l = |l| n the normal turns by (s . dl)/|l|, levers keep their shares of the
/// distance, and a mean displacement gradient H moves the ends apart by H dl:
///
///   d(dn) =  (s . dl) (s . du)/|l| + n . H dl,
///   d(ds) = -(s . dl) (n . du)/|l| + s . H dl - (n . dl) (r_i theta_i + r_j theta_j)/|l|,
///
/// with du = u_j - u_i + H l. For contacts on the line of centres.
#pragma once

#include "equidem/contact/frame.hpp"
#include "equidem/material/spring_relations.hpp"

namespace equidem {

/// The motion of a contact: of its ends beside a mean displacement gradient.
struct EndMotions {
  DiscMotion i, j;
  Tensor2 gradient{};
};

/// Stretch and slip, m.
inline ContactDeformation deformation(const ContactFrame& frame, Vec2 branch, const EndMotions& motion) {
  const Vec2 du = motion.j.u - motion.i.u + motion.gradient * branch;
  return deformation(frame, du.x, du.y, frame.lever_i * motion.i.theta + frame.lever_j * motion.j.theta);
}

/// The change of stretch and slip by dl.
inline ContactDeformation change_by_branch(const ContactFrame& frame, Vec2 branch, const EndMotions& motion, Vec2 dl) {
  const Vec2 n = frame.normal, s = frame.tangent();
  const Vec2 du = motion.j.u - motion.i.u + motion.gradient * branch, further = motion.gradient * dl;
  const double turn = dot(s, dl) / norm(branch), growth = dot(n, dl) / norm(branch);
  const double rolling = frame.lever_i * motion.i.theta + frame.lever_j * motion.j.theta;
  return {turn * dot(s, du) + dot(n, further), -turn * dot(n, du) + dot(s, further) - growth * rolling};
}

/// The change of slip where the contact point moves from i towards j by the unit length.
inline double slip_by_point(const EndMotions& motion) {
  return motion.j.theta - motion.i.theta;
}

/// Two motions of a contact and the deformations that count of them.
struct MotionPair {
  EndMotions a, b;
  ContactDeformation of_a, of_b;
};

/// Changes of kN dn_a dn_b + kT ds_a ds_b by the branch vector and as the contact point moves from i towards j.
struct EnergyByShape {
  Vec2 by_branch;       ///< N
  double by_point = 0;  ///< N
};

inline EnergyByShape energy_by_shape(const ContactFrame& frame, Vec2 branch, const SpringConstants& k,
                                     const MotionPair& pair) {
  const auto along = [&](Vec2 dl) {
    const ContactDeformation a = change_by_branch(frame, branch, pair.a, dl);
    const ContactDeformation b = change_by_branch(frame, branch, pair.b, dl);
    return k.kN * (a.normal * pair.of_b.normal + pair.of_a.normal * b.normal) +
           k.kT * (a.tangential * pair.of_b.tangential + pair.of_a.tangential * b.tangential);
  };
  return {{along({1, 0}), along({0, 1})},
          k.kT * (slip_by_point(pair.a) * pair.of_b.tangential + pair.of_a.tangential * slip_by_point(pair.b))};
}

}  // namespace equidem
