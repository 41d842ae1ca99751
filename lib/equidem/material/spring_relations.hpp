// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The two springs of a contact.
/// Relations between contact springs and the moduli of the continuum that an assembly of discs stands for (Abe 1996),
/// both ways. Those of lattices are in assembly/lattices.
/// The two springs of a contact in the parameters of other programs. Springs here are per metre of depth; the others
/// have springs in N/m, taken for a depth of 1 m: forces are then those per metre.
/// Contact springs and dashpots from wave speeds (Sukegawa 2010, section 2), and the step that they allow.
///
/// All functions throw Error (bad_input) on numbers that are not positive and finite (damping: negative).
#pragma once

#include <string>

#include "equidem/material/elastic_moduli.hpp"

namespace equidem {

/// Normal and tangential contact spring, N/m per metre of depth = Pa.
template <typename Number>
struct SpringConstantsOf {
  Number kN = 0;  ///< > 0
  Number kT = 0;  ///< any sign; negative is static-only

  [[nodiscard]] Number ratio() const { return kT / kN; }
};
using SpringConstants = SpringConstantsOf<double>;

/// \param of "of contact 7" for the message, or empty
/// \throws Error (bad_input) where kN is not positive and finite, or kT not finite
void check(const SpringConstants& springs, const std::string& of = {});

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

/// m: the depth for which other programs take the springs.
inline constexpr double engine_depth = 1;

/// `young` and `poisson` of the material of one body of YADE.
struct YadeMaterial {
  double young = 0;    ///< Pa
  double poisson = 0;  ///< there the ratio of the springs ks/kn
};

/// The material of a body of that radius with which contacts of any two bodies have these springs: young = kN depth /
/// radius, so that bodies of different radii have different materials. \param radius m
YadeMaterial yade_material(const SpringConstants& springs, double radius);

/// The springs, N/m over the depth, that YADE 2023.02 gives a contact (Ip2_FrictMat_FrictMat_FrictPhys and
/// Ip2_CohFrictMat_CohFrictMat_CohFrictPhys): kn = 2 E_i r_i E_j r_j / (E_i r_i + E_j r_j), ks likewise with E nu.
/// \param radius_i,radius_j m
SpringConstants yade_springs(const YadeMaterial& i, double radius_i, const YadeMaterial& j, double radius_j);

/// pb_kn and pb_ks, Pa/m, of a parallel bond of PFC 2D (radius multiplier 1): springs over its area, which is twice the
/// smaller radius times the depth. \param radius_i,radius_j m
SpringConstants pfc_parallel_bond(const SpringConstants& springs, double radius_i, double radius_j);

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
