// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Stiffness of a collision from duration, overlap or material constants.
///
/// All functions throw Error (bad_input) on numbers that are not positive and finite (damping ratio: negative; Poisson
/// ratio: outside (-1, 0.5]).
#pragma once

#include "equidem/contact/restitution.hpp"

namespace equidem {

/// Stiffness of a dimensionless stiffness a: k = a m/dt², N/m.
double stiffness_from_dimensionless(double a, double reduced_mass, double step);
/// The smallest k of a linear spring whose overlap does not exceed the given u at the closing speed v, for the given
/// end of the contact: e m v²/u², e = restitution_of(damping_ratio, at_zero_force), for u = v/w exp(-zeta
/// acos(zeta)/sqrt(1 - zeta²)).
double stiffness_from_overlap(double largest_overlap, double closing_speed, double reduced_mass, double damping_ratio);
/// Hertz stiffness k of F = k overlap^(3/2): (4/3) E* sqrt(R*), 1/E* = sum (1 - nu²)/E, 1/R* = sum 1/R; N/m^(3/2)
/// (Hertz).
double hertz_stiffness(double young_i, double poisson_i, double radius_i, double young_j, double poisson_j,
                       double radius_j);
/// Hertz stiffness against a rigid flat wall: R* = radius, 1/E* = (1 - nu²)/E.
double hertz_stiffness_on_rigid_wall(double young, double poisson, double radius);

/// Elastic impact of two bodies without gravity.
struct ElasticImpact {
  double overlap = 0;   ///< largest, m
  double force = 0;     ///< largest, N
  double duration = 0;  ///< s
};
/// Impact of linear springs: overlap v/w, duration pi/w, w = sqrt(k/m).
/// \param stiffness k of F = k overlap, N/m
/// \param speed closing, m/s
ElasticImpact linear_impact(double stiffness, double reduced_mass, double speed);
/// Impact of Hertz springs: overlap (5 m v²/(4 k))^(2/5), duration (4/5) sqrt(pi) Gamma(2/5)/Gamma(9/10) overlap/v =
/// 2.9433 overlap/v.
/// \param stiffness k of F = k overlap^(3/2), N/m^(3/2)
/// \param speed closing, m/s
ElasticImpact hertz_impact(double stiffness, double reduced_mass, double speed);

}  // namespace equidem
