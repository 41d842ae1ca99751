// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Contact springs and dashpots from wave speeds (Sukegawa 2010, section 2), and the step that they allow.
///
/// All functions throw Error (bad_input) on numbers that are not positive and finite (damping: negative).
#pragma once

#include "equidem/material/elastic_moduli.hpp"
#include "equidem/material/spring_constants.hpp"

namespace equidem {

/// Speeds of plane waves of a continuum, m/s.
struct WaveSpeeds {
  double shear = 0;     ///< Vs = sqrt(G/rho)
  double pressure = 0;  ///< Vp = sqrt((lambda + 2G)/rho)
};

/// \param density rho of the continuum, kg/m³
WaveSpeeds wave_speeds_of(const ElasticModuli& moduli, double density);
/// Vp = Vs sqrt(2 (1 - nu)/(1 - 2 nu)), plane strain.
/// \param poisson_ratio in (-1, 1/2)
WaveSpeeds wave_speeds_from_shear(double shear_speed, double poisson_ratio);

/// kN = (pi/4) rho Vp², kT = (pi/4) rho Vs² (2.26), Pa: each disc vibrates as the square around it, of the side 2r.
SpringConstants springs_of_wave_speeds(double density, const WaveSpeeds& speeds);

/// c = 2 h sqrt(m k) (2.27), N s/m per metre of depth; m is the mass of the disc. Of two such discs that meet, the
/// reduced mass is m/2 and the damping ratio sqrt(2) h.
double dashpot_of(double damping, double mass, double stiffness);

/// Damping ratios c/(2 sqrt(m' k)) of a contact whose two dashpots are c = 2 h sqrt(m k) (2.27). m is the mass of a
/// disc, m' what the contact moves: m/2 along the normal, m at a wall; by 1 + m r²/I less along the tangent.
struct ContactDamping {
  double normal = 0, tangential = 0;
};
/// \param inertia_factor I/(m r²)
ContactDamping contact_damping_of(double damping, bool at_wall, double inertia_factor);

/// Largest omega dt at which v' = v + a(x, v) dt, x' = x + v' dt is stable for x'' = -omega² x - 2 zeta omega x':
/// 2 (sqrt(1 + zeta²) - zeta).
double semi_implicit_limit(double damping_ratio);

}  // namespace equidem
