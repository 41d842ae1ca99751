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
#include <cstddef>

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

/// How a contact deforms with the motion (u_x, u_y, a theta) of the body at one of its ends.
struct EndGradient {
  std::array<double, 3> normal{}, tangential{};  ///< derivatives of stretch and slip
  std::array<double, 2> turns{};                 ///< derivatives of a theta_i and a theta_j by a theta

  /// Derivative of a (theta_j - theta_i) by a theta.
  [[nodiscard]] double bending() const { return turns[1] - turns[0]; }
};

struct EndGradients {
  EndGradient i, j;

  /// Both ends as one, where the contact joins a body to an image of itself that moves as `sign` times the body.
  [[nodiscard]] EndGradient as_one(double sign) const {
    EndGradient both;
    for (std::size_t k = 0; k < 3; ++k) {
      both.normal[k] = i.normal[k] + sign * j.normal[k];
      both.tangential[k] = i.tangential[k] + sign * j.tangential[k];
    }
    both.turns = {1, sign};
    return both;
  }
};

/// \param rotation_scale the length a (m) by which rotations are scaled
inline EndGradients end_gradients(const ContactFrame& frame, double rotation_scale) {
  const Vec2 n = frame.normal;
  const Vec2 s = frame.tangent();
  return {{{-n.x, -n.y, frame.offset_i / rotation_scale}, {-s.x, -s.y, -frame.lever_i / rotation_scale}, {1, 0}},
          {{n.x, n.y, frame.offset_j / rotation_scale}, {s.x, s.y, -frame.lever_j / rotation_scale}, {0, 1}}};
}

/// The tangent of a contact, by blocks between the motions of its ends:
///
///   K_pq = kN n_p n_q^T + kT t_p t_q^T + kM b_p b_q^T + prestress,   p, q in {i, j}
///
/// with the derivatives n of stretch, t of slip and b of relative rotation. A contact that slips has in place of kT t_p
/// t_q^T the block `tn` t_p n_q^T, which is not symmetric.
struct ContactStiffness {
  EndGradients ends;
  double kN = 0, kT = 0;                        ///< Pa
  double kM = 0;                                ///< Pa: that of the bending spring over a²
  double tn = 0;                                ///< Pa: dT by stretch
  const ContactPrestress* prestress = nullptr;  ///< null: none
  double rotation_scale = 1;                    ///< a, m; read with prestress

  [[nodiscard]] ContactStiffness normal_part() const { return {.ends = ends, .kN = kN}; }
  [[nodiscard]] ContactStiffness tangential_part() const { return {.ends = ends, .kT = kT, .tn = tn}; }
  /// Stiffnesses over `unit`, Pa. Without prestress.
  void divide(double unit) {
    kN /= unit, kT /= unit;
    if (kM != 0) kM /= unit;
  }
  /// block += K_pq, row-major B x B; B = 2 leaves rotations out.
  template <int B>
  void add(const EndGradient& p, const EndGradient& q, double* block) const {
    for (int r = 0; r < B; ++r)
      for (int c = 0; c < B; ++c)
        block[r * B + c] += kN * p.normal[r] * q.normal[c] + kT * p.tangential[r] * q.tangential[c];
    if (tn != 0) {
      for (int r = 0; r < B; ++r)
        for (int c = 0; c < B; ++c) block[r * B + c] += tn * p.tangential[r] * q.normal[c];
    }
    if (prestress != nullptr) add_prestress<B>(p, q, block);
    if (B == 3 && kM != 0) block[8] += kM * p.bending() * q.bending();
  }

 private:
  template <int B>
  void add_prestress(const EndGradient& p, const EndGradient& q, double* block) const {
    const double turn = 1 / rotation_scale;
    const auto turns = [&](const EndGradient& end, int k) {
      return k == 2 ? std::array{end.turns[0] * turn, end.turns[1] * turn} : std::array<double, 2>{};
    };
    for (int r = 0; r < B; ++r) {
      for (int c = 0; c < B; ++c) {
        const auto [r_i, r_j] = turns(p, r);
        const auto [c_i, c_j] = turns(q, c);
        block[r * B + c] += prestress_form(*prestress, {p.normal[r], p.tangential[r]}, r_i, r_j,
                                           {q.normal[c], q.tangential[c]}, c_i, c_j);
      }
    }
  }
};

// How the energy of a contact on the line of centres changes with the places and radii of its discs while their motions
// stay. Under a change dl of the branch vector l = |l| n the normal turns by (s . dl)/|l|, levers keep their shares of
// the distance, and a mean displacement gradient H moves the ends apart by H dl:
//
//   d(dn) =  (s . dl) (s . du)/|l| + n . H dl,
//   d(ds) = -(s . dl) (n . du)/|l| + s . H dl - (n . dl) (r_i theta_i + r_j theta_j)/|l|,
//
// with du = u_j - u_i + H l.

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
