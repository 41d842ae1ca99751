// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The linear contact law, shared by the static and the dynamic solver: force, tangent, energy.
///
///   energy   W = kN dn²/2 + kT ds²/2
///   force    f = dW/d(dn, ds) = (kN dn, kT ds)
///   tangent  K = d²W/dq² with q = (u_i, a theta_i, u_j, a theta_j)
///
/// (Abe 1996, eqs. 1-5.) kN > 0; kT may be negative in statics, where the assembly stays regular down to its critical
/// ratio kT/kN.
#pragma once

#include <array>

#include "equidem/contact/frame.hpp"
#include "equidem/material/spring_constants.hpp"

namespace equidem {

inline ContactForce linear_spring_force(const SpringConstants& k, const ContactDeformation& d) {
  return {k.kN * d.normal, k.kT * d.tangential};
}

/// N, per metre of depth (J/m per m).
inline double linear_spring_energy(const SpringConstants& k, const ContactDeformation& d) {
  return 0.5 * (k.kN * d.normal * d.normal + k.kT * d.tangential * d.tangential);
}

/// Derivatives of the deformation by the motion (u_x, u_y, a theta) of one of the two discs; the tangent is made of
/// them: K_pq = kN n_p n_q^T + kT t_p t_q^T for p, q in {i, j}.
struct DeformationGradient {
  std::array<double, 3> normal_i, normal_j;          ///< d dn / d(u_x, u_y, a theta)
  std::array<double, 3> tangential_i, tangential_j;  ///< d ds / d(u_x, u_y, a theta)
};

/// \param rotation_scale the length a (m) by which rotations are scaled
inline DeformationGradient deformation_gradient(const ContactFrame& frame, double rotation_scale) {
  const Vec2 n = frame.normal;
  const Vec2 s = frame.tangent();
  return {{-n.x, -n.y, 0.0},
          {n.x, n.y, 0.0},
          {-s.x, -s.y, -frame.lever_i / rotation_scale},
          {s.x, s.y, -frame.lever_j / rotation_scale}};
}

}  // namespace equidem
