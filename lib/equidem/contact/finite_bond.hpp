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
#pragma once

#include <cmath>
#include <numbers>

#include "equidem/assembly/assembly.hpp"
#include "equidem/contact/frame.hpp"
#include "equidem/contact/linear_spring.hpp"
#include "equidem/material/spring_constants.hpp"

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

/// Rate of the deformation at the given velocity, for dashpots.
template <typename Number>
DeformationOf<Number> bond_deformation_rate(const FiniteBond& bond, const BondMotion<Number>& motion,
                                            const BondMotion<Number>& velocity) {
  const Number lx = bond.branch.x + motion.x, ly = bond.branch.y + motion.y;
  const Number square = lx * lx + ly * ly;
  const Number levers = Number(bond.lever_i) + Number(bond.lever_j);
  return {(lx * velocity.x + ly * velocity.y) / std::sqrt(square),
          levers * (lx * velocity.y - ly * velocity.x) / square - bond.lever_i * velocity.theta_i -
              bond.lever_j * velocity.theta_j};
}

/// Forces and moments on the two bodies by the generalized force (f_N, f_T) conjugate to (dn, ds): the transpose of the
/// rate.
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

}  // namespace equidem
