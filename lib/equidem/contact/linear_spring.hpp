// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The linear contact law, shared by the static and the dynamic solver: force, tangent, energy.
///
///   energy   W = kN dn²/2 + kT ds²/2
///   force    f = dW/d(dn, ds) = (kN dn, kT ds)
///   tangent  K = d²W/dq² with q = (u_i, a theta_i, u_j, a theta_j)
///
/// (Abe 1996, eqs. 1-5.) kN > 0; kT may be negative in statics, where the assembly stays regular down to its critical
/// ratio kT/kN. A bond that resists the relative rotation of its bodies, as a cemented one of some width does (Potyondy
/// & Cundall 2004), stores kM (theta_j - theta_i)²/2 beside W and turns i by kM (theta_j - theta_i), j by its negative.
#pragma once

#include <array>

#include "equidem/contact/frame.hpp"
#include "equidem/contact/prestress/prestress.hpp"
#include "equidem/material/spring_relations.hpp"

namespace equidem {

template <typename Number>
ForceOf<Number> linear_spring_force(const SpringConstants& k, const DeformationOf<Number>& d) {
  return {k.kN * d.normal, k.kT * d.tangential};
}

/// The moment of the bending spring kM on i, N; its negative acts on j.
template <typename Number>
Number bending_moment(double kM, Number theta_i, Number theta_j) {
  return kM * (theta_j - theta_i);
}

/// Elastic energy of the bending spring, N.
inline double bending_energy(double kM, double theta_i, double theta_j) {
  return 0.5 * kM * (theta_j - theta_i) * (theta_j - theta_i);
}

/// Elastic energy, N (J/m).
inline double linear_spring_energy(const SpringConstants& k, const ContactDeformation& d) {
  return 0.5 * (k.kN * d.normal * d.normal + k.kT * d.tangential * d.tangential);
}

/// Elastic energy from the force: f_N²/2kN + f_T²/2kT; an absent spring stores none.
inline double linear_spring_energy_of(const SpringConstants& k, const ContactForce& f) {
  const double tangential = k.kT != 0 ? f.tangential * f.tangential / k.kT : 0.0;
  return 0.5 * (f.normal * f.normal / k.kN + tangential);
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
  return {{-n.x, -n.y, frame.offset_i / rotation_scale},
          {n.x, n.y, frame.offset_j / rotation_scale},
          {-s.x, -s.y, -frame.lever_i / rotation_scale},
          {s.x, s.y, -frame.lever_j / rotation_scale}};
}

/// block += kN g_p g_q^T + kT h_p h_q^T, row-major B x B: the tangent between the ends p and q of a contact, from the
/// derivatives g of stretch and h of slip by the motion of each end. B = 2 leaves rotations out.
template <int B>
void add_linear_spring_tangent(const SpringConstants& k, const std::array<double, 3>& normal_p,
                               const std::array<double, 3>& normal_q, const std::array<double, 3>& tangential_p,
                               const std::array<double, 3>& tangential_q, double* block) {
  for (int r = 0; r < B; ++r) {
    for (int c = 0; c < B; ++c) {
      block[r * B + c] += k.kN * normal_p[r] * normal_q[c] + k.kT * tangential_p[r] * tangential_q[c];
    }
  }
}

/// block += the tangent of the bending spring kM on the rotations of one body, or with `between` that of one body by
/// the other; nothing where B = 2.
template <int B>
void add_bending_tangent(double kM, double rotation_scale, bool between, double* block) {
  if constexpr (B == 3) block[8] += (between ? -kM : kM) / (rotation_scale * rotation_scale);
}

/// block += the prestress of a contact between its ends p and q, as add_linear_spring_tangent.
/// \param turns_p, turns_q derivatives of (theta_i, theta_j) by a theta of each end: (1/a, 0) of i, (0, 1/a) of j
template <int B>
void add_prestress_tangent(const ContactPrestress& g, const std::array<double, 3>& normal_p,
                           const std::array<double, 3>& normal_q, const std::array<double, 3>& tangential_p,
                           const std::array<double, 3>& tangential_q, const std::array<double, 2>& turns_p,
                           const std::array<double, 2>& turns_q, double* block) {
  for (int r = 0; r < B; ++r) {
    for (int c = 0; c < B; ++c) {
      const double r_i = r == 2 ? turns_p[0] : 0, r_j = r == 2 ? turns_p[1] : 0;
      const double c_i = c == 2 ? turns_q[0] : 0, c_j = c == 2 ? turns_q[1] : 0;
      block[r * B + c] +=
          prestress_form(g, {normal_p[r], tangential_p[r]}, r_i, r_j, {normal_q[c], tangential_q[c]}, c_i, c_j);
    }
  }
}

}  // namespace equidem
