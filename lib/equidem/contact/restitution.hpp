// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Damping ratio from the coefficient of restitution.
///
/// Stiffness of a collision from duration, overlap or material constants.
///
/// All functions throw Error (bad_input) on numbers that are not positive and finite (damping ratio: negative; Poisson
/// ratio: outside (-1, 0.5]).
#pragma once

#include "equidem/core/names.hpp"

namespace equidem {

/// Criterion of the end of a contact of spring and dashpot; the restitution depends on it.
enum class ContactEnd {
  at_zero_overlap,  ///< the force may attract while the bodies part: e = exp(-pi zeta/sqrt(1 - zeta²))
  at_zero_force,    ///< the force is never attractive (Schwager & Poeschel 2007)
};

template <>
struct EnumNames<ContactEnd> {
  static constexpr const char* what = "end of a contact";
  static constexpr NamedValue<ContactEnd> list[] = {{ContactEnd::at_zero_overlap, "zero_overlap"},
                                                    {ContactEnd::at_zero_force, "zero_force"}};
};

/// Duration of an impact of linear spring and dashpot, without gravity, times sqrt(k/m): at zero overlap pi/sqrt(1 -
/// zeta²), infinite from zeta = 1 on; at zero force 2 acos(zeta)/sqrt(1 - zeta²) for zeta < 1, 2 at 1, 2
/// acosh(zeta)/sqrt(zeta² - 1) above. \param damping_ratio zeta = c/(2 sqrt(m k)), m the reduced mass, >= 0
double contact_phase_of(double damping_ratio, ContactEnd end);

/// Restitution of such an impact: exp(-zeta contact_phase), for either end.
double restitution_of(double damping_ratio, ContactEnd end);

/// The zeta with restitution_of(zeta, end) = e to round-off.
/// \throws Error (bad_input) where e is outside [0, 1], or 0 for a contact that ends at zero force (it would need an
///         infinite dashpot)
double damping_ratio_of(double restitution, ContactEnd end);

/// \return the restitution
/// \throws Error (bad_input) where it is outside [0, 1]
double checked_restitution(double restitution);

/// alpha of a Hertz spring k d^(3/2) with the dashpot alpha sqrt(m k) d^(1/4) (Tanaka): sqrt(5) damping_ratio_of(e,
/// end), exact for either end, because velocity against d^(5/4) is that of a linear spring and dashpot with zeta =
/// alpha/sqrt(5). At zero overlap it is the paper's -sqrt(5) ln e/sqrt(pi² + ln² e), sqrt(5) at e = 0.
/// \throws Error (bad_input) as damping_ratio_of
double hertz_damping_of(double restitution, ContactEnd end = ContactEnd::at_zero_overlap);

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
