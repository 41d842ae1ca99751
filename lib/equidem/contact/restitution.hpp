// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Damping ratio from the coefficient of restitution.
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

}  // namespace equidem
