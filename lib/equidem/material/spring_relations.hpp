// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Relations between contact springs and the moduli of the continuum that an assembly of discs stands for (Abe 1996),
/// both ways. Those of lattices are in assembly/lattices.
#pragma once

#include "equidem/material/elastic_moduli.hpp"
#include "equidem/material/spring_constants.hpp"

namespace equidem {

/// Measures of an isotropic assembly, of eqs. (20) and (21).
struct IsotropicMeasures {
  double solid_fraction = 0;   ///< phi = gamma/rho, in (0, 1]
  double contact_density = 0;  ///< psi = z/(2 pi), contacts per radian around one disc
};

/// The two moduli of a sheet whose signs decide about stability.
struct SheetModuli {
  double bulk = 0;   ///< K = G/(1 - 2 nu) in plane strain, Pa
  double shear = 0;  ///< G, Pa
};

/// A relation between equal springs and the moduli of an isotropic continuum.
struct SpringRelation {
  const char* name;                     ///< "hexagonal lattice, eq. (34)": reports
  const char* place;                    ///< "square lattice": messages
  const char* source;                   ///< "Abe 1996, eq. 34": where it is derived, for reports and messages
  const char* validity;                 ///< "holds for nu <= 1/4 (plane strain): ...", a sentence or two for reports
  const char* static_limit;             ///< where kT < 0 is statically stable, a clause for messages
  bool needs_measures = false;          ///< IsotropicMeasures are used
  const char* equal_springs = nullptr;  ///< where the relation holds for kT = kN and nu = 0 only: why, else null
  const char* shear_limit = "-1";       ///< kT/kN at which G vanishes, for messages
  SheetModuli (*moduli)(const SpringConstants& springs, const IsotropicMeasures& measures);
  /// \param one_minus_4nu 1 - 4 nu in plane strain, exactly 0 where kT vanishes
  SpringConstants (*springs)(const ElasticModuli& moduli, double one_minus_4nu, const IsotropicMeasures& measures);
};

/// Mean field, eqs. (20) to (22): K = phi psi kN, G = phi psi (kN + kT)/2.
extern const SpringRelation isotropic_relation;

/// q = G/K of springs with this kT/kN; infinite where K is not positive.
/// \throws Error (bad_input) as the relation
double shear_to_bulk(const SpringRelation& relation, double ratio, const IsotropicMeasures& measures = {});

/// The values of q that a relation gives without negative springs.
struct ShearToBulkRange {
  double least;     ///< at kT = 0
  double greatest;  ///< as kT/kN grows; infinite where q grows without bound
};
/// \throws Error (bad_input) as the relation
ShearToBulkRange shear_to_bulk_range(const SpringRelation& relation, const IsotropicMeasures& measures = {});

/// Treatment of moduli whose relation yields kT < 0.
enum class NegativeTangential {
  refuse,
  static_only,  ///< continue the relation: a static answer exists down to the critical ratio, a dynamic one does not
};

/// \throws Error (bad_input) with the range that can be represented: nu that needs kT < 0 (hexagonal lattice: above 1/4
///         in plane strain, 1/3 in plane stress) unless the static-only continuation is asked for, nu below that of
///         kT/kN -> infinity, nu other than 0 on the square lattice, missing measures
SpringConstants springs_for(const ElasticModuli& moduli, const SpringRelation& relation,
                            const IsotropicMeasures& measures = {},
                            NegativeTangential negative = NegativeTangential::refuse);

/// The moduli that springs stand for, the inverse of springs_for.
/// \throws Error (bad_input) where the springs stand for no isotropic continuum (square lattice with kT != kN) or for
///         no stable one (kN <= 0, kT/kN at or below the limit where G or K is no longer positive)
ElasticModuli moduli_of(const SpringConstants& springs, const SpringRelation& relation,
                        const IsotropicMeasures& measures = {}, Plane plane = Plane::strain);

/// nu = (1 - kT/kN)/4, plane strain: eq. (22), and the hexagonal lattice.
double poisson_ratio_of_ratio(double ratio);
/// nu = -e22/(e11 - e22) of a uniaxial test along x, plane strain: eq. (35).
double poisson_ratio_of_strains(double e11, double e22);

}  // namespace equidem
