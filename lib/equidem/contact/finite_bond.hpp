// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The bond of two discs whose normal and contact point follow the bodies, for motions of any size.
///
/// With l0 the branch at rest, l = l0 + u_j - u_i the present one, n = l/|l|, s = (-n_y, n_x), and psi the angle by
/// which l has turned from l0:
///
///   stretch  dn = |l| - |l0|
///   slip     ds = r_i (psi - theta_i) + r_j (psi - theta_j) = (r_i + r_j) (psi - theta),
///            theta the mean of the two rotations, weighted with the levers
///   energy   W = kN dn²/2 + kT ds²/2
///   force on i, -dW/du_i:         kN dn n + kT ds (r_i + r_j)/|l| s;  on j its negative
///   moment on i, -dW/dtheta_i:    kT ds r_i;                          on j: kT ds r_j
///
/// A bond that resists bending stores kM (theta_j - theta_i)²/2 beside W, whole turns included, and adds the moment kM
/// (theta_j - theta_i) on i and its negative on j.
///
/// W is a function of the motion alone: without dashpots energy is conserved. A rigid motion stores no energy, and
/// forces and moments balance for any levers. psi is defined modulo 2 pi: psi - theta is taken in [-pi, pi], which is
/// correct for turns of an assembly, rolling discs (theta_i = -theta_j) and any number of whole turns; only a bond that
/// slips by half a turn, pi (r_i + r_j), is released. Where r_i + r_j = |l0|, the law is to first order that of
/// linear_spring.hpp (Abe 1996, eqs. 1-5), and the tangent at rest is the stiffness matrix.
///
/// Two discs bonded by dashpots (Sukegawa 2010, (5.1)-(5.19)): along the line of their centres, across it at the point
/// of the bond, and optionally against their relative spin.
///
/// With n from i to j, s = (-n_y, n_x) and levers a_i, a_j that add up to the distance of the centres, so that the
/// point of the bond is the same of both (5.16) and angular momentum is kept:
///
///   rates       v_n = (v_j - v_i) . n,  v_s = (v_j - v_i) . s - a_i w_i - a_j w_j,  v_r = w_j - w_i
///   forces      C_n v_n, C_s v_s, moment C_r v_r; pulling or pushing, whatever their size: (5.12) means no limit of
///   friction masses      1/m_n = 1/m_i + 1/m_j,  1/m_s = 1/m_n + a_i²/I_i + a_j²/I_j,  1/m_r = 1/I_i + 1/I_j
///
/// A bond alone decays as exp(-C t/m) in each. Dashpots leave free the rigid motions and the rolling v_s = 0, w_i =
/// -w_j (unless C_r > 0), and a steady tension N makes them creep at the rate N/C_n.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "equidem/assembly/assembly.hpp"
#include "equidem/contact/frame.hpp"
#include "equidem/contact/linear_spring.hpp"
#include "equidem/material/spring_relations.hpp"

namespace equidem {

struct FiniteBond {
  Vec2 branch;         ///< l0, m; not zero
  double lever_i = 0;  ///< m
  double lever_j = 0;  ///< m
  SpringConstants springs;
  double kM = 0;  ///< N m/rad (per metre of depth)
};

inline FiniteBond bond_of(const Assembly& assembly, const Contact& contact, const SpringConstants& springs,
                          double kM = 0) {
  return {assembly.branch(contact), contact.lever_i, contact.lever_j, springs, kM};
}

/// Relative motion (or velocity) of the two discs of a bond: u_j - u_i (m) and the rotations (rad), including whole
/// turns.
template <typename Number>
struct BondMotion {
  Number x = 0, y = 0;
  Number theta_i = 0, theta_j = 0;
};

inline BondMotion<double> bond_motion(const DiscMotion& i, const DiscMotion& j) {
  const Vec2 du = j.u - i.u;
  return {du.x, du.y, i.theta, j.theta};
}

/// Force on i (N/m; its negative acts on j) and the moments on both (N).
template <typename Number>
struct BondForces {
  Number x = 0, y = 0;
  Number moment_i = 0, moment_j = 0;
};

template <typename Number>
DeformationOf<Number> bond_deformation(const FiniteBond& bond, const BondMotion<Number>& motion) {
  const Number at_rest_x = bond.branch.x, at_rest_y = bond.branch.y;
  const Number lx = at_rest_x + motion.x, ly = at_rest_y + motion.y;
  const Number length = std::sqrt(lx * lx + ly * ly);
  const Number length_at_rest = std::sqrt(at_rest_x * at_rest_x + at_rest_y * at_rest_y);
  // |l| - |l0| = (l² - l0²)/(|l| + |l0|): without the difference of two nearly equal numbers.
  const Number stretch = (motion.x * (at_rest_x + lx) + motion.y * (at_rest_y + ly)) / (length + length_at_rest);

  const Number levers = Number(bond.lever_i) + Number(bond.lever_j);
  if (levers == 0) return {stretch, 0};
  const Number turn = std::atan2(at_rest_x * motion.y - at_rest_y * motion.x, at_rest_x * lx + at_rest_y * ly);
  const Number mean_rotation = (bond.lever_i * motion.theta_i + bond.lever_j * motion.theta_j) / levers;
  return {stretch, levers * std::remainder(turn - mean_rotation, 2 * std::numbers::pi_v<Number>)};
}

/// Forces and moments on the two bodies by the generalized force (f_N, f_T) conjugate to (dn, ds): the transpose of
/// their rates.
template <typename Number>
BondForces<Number> bond_forces(const FiniteBond& bond, const BondMotion<Number>& motion, const ForceOf<Number>& force) {
  const Number lx = bond.branch.x + motion.x, ly = bond.branch.y + motion.y;
  const Number square = lx * lx + ly * ly;
  const Number along = force.normal / std::sqrt(square);
  const Number across = force.tangential * (Number(bond.lever_i) + Number(bond.lever_j)) / square;
  return {along * lx - across * ly, along * ly + across * lx, bond.lever_i * force.tangential,
          bond.lever_j * force.tangential};
}

/// Forces and moments of the springs.
template <typename Number>
BondForces<Number> bond_forces(const FiniteBond& bond, const BondMotion<Number>& motion) {
  BondForces<Number> forces =
      bond_forces(bond, motion, linear_spring_force(bond.springs, bond_deformation(bond, motion)));
  const Number bending = bending_moment(bond.kM, motion.theta_i, motion.theta_j);
  forces.moment_i += bending;
  forces.moment_j -= bending;
  return forces;
}

/// Elastic energy, N (J/m).
template <typename Number>
Number bond_energy(const FiniteBond& bond, const BondMotion<Number>& motion) {
  const DeformationOf<Number> d = bond_deformation(bond, motion);
  const Number twist = motion.theta_j - motion.theta_i;
  return (bond.springs.kN * d.normal * d.normal + bond.springs.kT * d.tangential * d.tangential +
          bond.kM * twist * twist) /
         2;
}

inline double bond_energy(const FiniteBond& bond, const DiscMotion& i, const DiscMotion& j) {
  return bond_energy(bond, bond_motion(i, j));
}

/// Three numbers of the three dashpots: C (N s/m, N s/m, N m s), rates, inverse masses, impulses.
struct BondModes {
  double normal = 0, tangential = 0, rolling = 0;
};

/// 1/mass and 1/moment of inertia of a disc.
struct InverseInertia {
  double mass = 0, moment = 0;
};

/// 1/m_n, 1/m_s, 1/m_r.
inline BondModes bond_inverse_masses(const ContactFrame& frame, const InverseInertia& i, const InverseInertia& j) {
  const double along = i.mass + j.mass;
  return {along, along + frame.lever_i * frame.lever_i * i.moment + frame.lever_j * frame.lever_j * j.moment,
          i.moment + j.moment};
}

/// Largest eigenvalue of M^-1 B^T C B, B the rates: how fast a bond alone decays (C dashpots, 1/s), or the square of
/// its highest frequency (C springs, 1/s²). Spin couples v_s and v_r of unequal discs.
inline double largest_bond_rate(const BondModes& c, const ContactFrame& frame, const InverseInertia& i,
                                const InverseInertia& j) {
  const BondModes inverse = bond_inverse_masses(frame, i, j);
  const double p = c.tangential * inverse.tangential, q = c.rolling * inverse.rolling;
  const double coupling = frame.lever_i * i.moment - frame.lever_j * j.moment;
  const double turning =
      0.5 * (p + q) + std::sqrt(0.25 * (p - q) * (p - q) + c.tangential * c.rolling * coupling * coupling);
  return std::max(c.normal * inverse.normal, turning);
}

/// Decay of a rate by a dashpot over a step, x = C dt/m >= 0.
struct Decay {
  double keep = 1;  ///< e^-x
  double mean = 1;  ///< (1 - e^-x)/x, the mean of e^(-x t) over t in 0..1
};

/// Decay to 1e-15, bit-identical on every machine: the series of (1 - e^-y)/y for y = x/2^k <= 1/2, doubled k times.
inline Decay decay(double x) {
  if (x > 40) return {0, 1 / x};
  int doublings = 0;
  double y = x;
  while (y > 0.5) {
    y *= 0.5;
    ++doublings;
  }
  double mean = 1;
#pragma GCC unroll 14
  for (int k = 15; k >= 2; --k) mean = 1 - y * (1.0 / k) * mean;
  double keep = 1 - y * mean;
  for (; doublings > 0; --doublings) {
    mean *= 0.5 * (1 + keep);
    keep *= keep;
  }
  return {keep, mean};
}

/// Longest step of semi-implicit Euler with dashpots taken at its start: modes of M^-1 K <= square (1/s²), M^-1 C <=
/// rate (1/s) are stable while square dt² + 2 rate dt < 4. rate = 0 (no dashpots): 2/omega. Infinite where both are 0.
inline double bond_step_limit(double rate, double square) {
  return 4 / (rate + std::sqrt(rate * rate + 4 * square));
}

}  // namespace equidem
