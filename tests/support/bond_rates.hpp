// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Rates of the deformation of bonds, for comparison with the loops.
#pragma once

#include <cmath>

#include "equidem/contact/finite_bond.hpp"

namespace equidem::test {

/// v_n, v_s, v_r. \param i, j velocities and spins
inline BondModes bond_rates(const ContactFrame& frame, const DiscMotion& i, const DiscMotion& j) {
  const ContactDeformation rate = deformation(frame, i, j);
  return {rate.normal, rate.tangential, j.theta - i.theta};
}

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

}  // namespace equidem::test
