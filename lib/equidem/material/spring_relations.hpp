// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Abe (1996): contact springs and the moduli of the continuum that an assembly of discs stands for, both ways.
#pragma once

#include <string>

#include "equidem/material/elastic_moduli.hpp"
#include "equidem/material/spring_constants.hpp"

namespace equidem {

/// The arrangements for which Abe gives a relation.
enum class Packing {
  isotropic,             ///< eqs. (21), (22): mean field, needs solid fraction and contact density
  hexagonal,             ///< eq. (34)
  square,                ///< eq. (31): nu = 0 only
  hexagonal_restrained,  ///< eq. (53), rotation restrained: matches the displacement operator, not the stress
};

/// Measures of an isotropic assembly that eqs. (20)-(21) ask for.
struct IsotropicMeasures {
  double solid_fraction = 0;   ///< phi = gamma/rho, in (0, 1]
  double contact_density = 0;  ///< psi = z/(2 pi), contacts per radian around one disc
};

/// What to do where a relation asks for kT < 0.
enum class NegativeTangential {
  refuse,
  static_only,  ///< continue the relation: a static answer exists down to the critical ratio, no dynamic one
                ///< does
};

/// \throws Error (bad_input) with the sentence that says what is representable: nu > 1/4 in plane strain (1/3 in
///         plane stress) unless the static-only continuation is asked for, anything but nu = 0 on the square lattice,
///         missing measures
SpringConstants springs_for(const ElasticModuli& moduli, Packing packing, const IsotropicMeasures& measures = {},
                            NegativeTangential negative = NegativeTangential::refuse);

/// The moduli that springs stand for, the inverse of springs_for.
/// \throws Error (bad_input) where the springs stand for no isotropic continuum (square lattice with kT != kN) or for
///         no stable one (kN <= 0, kT/kN at or below the limit where G or K is no longer positive)
ElasticModuli moduli_of(const SpringConstants& springs, Packing packing, const IsotropicMeasures& measures = {},
                        Plane plane = Plane::strain);

/// "holds for nu <= 1/4 (plane strain): ...", one sentence for reports.
std::string validity(Packing packing);

/// nu = (1 - kT/kN)/4, plane strain: eq. (22), also the hexagonal lattice's.
double poisson_ratio_of_ratio(double ratio);
/// 2G/((1 - nu) kN) = 2 sqrt3 (1 + r)/(3 + r), r = kT/kN, hexagonal: eq. (37).
double hexagonal_stiffness_ratio(double ratio);
/// nu = -e22/(e11 - e22) of a uniaxial test along x, plane strain: eq. (35).
double poisson_ratio_of_strains(double e11, double e22);

}  // namespace equidem
