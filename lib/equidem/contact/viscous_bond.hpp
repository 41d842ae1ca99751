// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
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

#include "equidem/contact/frame.hpp"

namespace equidem {

/// Three numbers of the three dashpots: C (N s/m, N s/m, N m s), rates, inverse masses, impulses.
struct BondModes {
  double normal = 0, tangential = 0, rolling = 0;
};

/// \param i, j velocities and spins, or what these gain in a step
inline BondModes bond_rates(const ContactFrame& frame, const DiscMotion& i, const DiscMotion& j) {
  const ContactDeformation rate = deformation(frame, i, j);
  return {rate.normal, rate.tangential, j.theta - i.theta};
}

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

/// Change of a rate v by a dashpot alone: v' = -(C/m) v + g. `before`: jumps of v at the start of the step (other
/// bonds); `gained` = g dt, what steady forces add over the step. Exact, whatever x = C dt/m: no limit to the step, and
/// where g is steady v comes to g m/C. \return change of the rate over the step by the dashpot
inline double exact_dashpot_change(double x, double rate, double before, double gained) {
  const Decay left = decay(x);
  return -x * left.mean * (rate + before) - (1 - left.mean) * gained;
}

/// The change by the rate at the start of the step (Sukegawa (5.2), (5.8)): stable for x < 2.
inline double explicit_dashpot_change(double x, double rate) {
  return -x * rate;
}

/// Longest step of semi-implicit Euler with dashpots taken at its start: modes of M^-1 K <= square (1/s²), M^-1 C <=
/// rate (1/s) are stable while square dt² + 2 rate dt < 4. rate = 0 (no dashpots): 2/omega. Infinite where both are 0.
inline double bond_step_limit(double rate, double square) {
  return 4 / (rate + std::sqrt(rate * rate + 4 * square));
}

}  // namespace equidem
