// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The strain fields of a homogenization give the exact derivatives of the effective stiffness by each spring.
///
/// The energy of a pair of mean strains a, b is stationary in the fluctuations, so that a spring counts by its own
/// stretch alone (Hellmann-Feynman). With the stretches n, the slips s and the relative rotations w of contact c under
/// unit mean strains, and the area A,
///
///   dC_ab/dkN_c = n_a n_b/A,   dC_ab/dkT_c = s_a s_b/A,   dC_ab/dkM_c = w_a w_b/A.
///
/// In the same way places and radii count by what they do to stretches and slips while the fluctuations stay
/// (linear_spring.hpp).
///
/// Without forces at rest C = sum kN dC/dkN + kT dC/dkT + kM dC/dkM (Euler, C is homogeneous in the springs).
#pragma once

#include <array>
#include <vector>

#include "equidem/homogenize/effective_stiffness.hpp"
#include "equidem/homogenize/elasticity_tensor.hpp"
#include "equidem/statics/adjoint.hpp"

namespace equidem {

/// Per contact, rows and columns as those of `stiffness`; 0 where a contact carries no load.
struct SpringSensitivities {
  std::vector<Matrix3> by_kN, by_kT;  ///< Pa/Pa
  std::vector<Matrix3> by_kM;         ///< 1/m²; empty where contacts do not bend
};

/// \param result of the same assembly and springs
/// \throws Error (bad_input) for tractions, whose strains are not prescribed; where the network is not stable, since C
///         changes without bound at a limit of stability
SpringSensitivities spring_sensitivities(const Assembly& assembly, const ContactSprings& springs,
                                         const EffectiveStiffness& result);

/// Per disc; springs, contacts and the period stay as they are. 0 where a disc carries no load.
struct ShapeSensitivities {
  std::vector<std::array<Matrix3, 2>> by_position;  ///< Pa/m, along x and y; levers keep their shares of the distance
  /// Pa/m; empty where contact points do not lie as the radii say (ContactPoints::radii).
  std::vector<Matrix3> by_radius;
};

/// \param result of the same assembly and springs
/// \throws Error (bad_input) as spring_sensitivities; for samples that are not periodic, whose area changes; where
///         contact points are off the line of centres, or forces at rest count
ShapeSensitivities shape_sensitivities(const Assembly& assembly, const ContactSprings& springs,
                                       const EffectiveStiffness& result);

/// Whether shape_sensitivities takes the assembly and its springs.
bool has_shape_sensitivities(const Assembly& assembly, const ContactSprings& springs);

/// Changes of the moduli (plane stress) by a change of the stiffness: EffectiveModuli linearized.
struct ModuliChange {
  double bulk_modulus_2d = 0, shear_modulus = 0, young_modulus = 0;
  double poisson_ratio = 0;
};
/// \param stiffness Pa, about which moduli change \param change of it
ModuliChange change_of_moduli(const Matrix3& stiffness, const Matrix3& change);

/// Derivatives of one of the moduli by the springs.
SpringDerivatives modulus_by_springs(const Matrix3& stiffness, const SpringSensitivities& sensitivities,
                                     double ModuliChange::*modulus);

struct MeanShiftOptions {
  Rotation rotation = Rotation::from_scene;
  SolverOptions solver = {};
  int probes = 16;         ///< >= 2; each takes three solutions
  std::uint64_t seed = 1;  ///< of the probes
};

/// A mean and its standard error over random probes.
struct MeanShift {
  ModuliChange shift, standard_error;
};

/// The shift of the mean moduli over the square of the coefficient of variation of the springs, to second order, where
/// those of each contact (kN, kT and kM by one factor s_c of mean 1) scatter independently: half the sum of the second
/// derivatives by s_c. Along a direction z of the factors, with the states u_a of unit mean strains, the stiffness has
///
///   d²C_ab/dt² = -2 b_a . K^-1 b_b/A,   b_a = D^T z k D u_a,
///
/// whose mean over random signs z is the sum over contacts (Hutchinson 1990, Commun. Stat. Simul. 19, 433). E and nu
/// also shift by the variances of K and G, which are known exactly. Forces at rest stay what they are.
/// \param result, sensitivities of the same assembly and springs
/// \throws Error (bad_input) for fewer than two probes; as spring_sensitivities, and as effective_stiffness
MeanShift mean_shift_of_moduli(const Assembly& assembly, const ContactSprings& springs,
                               const EffectiveStiffness& result, const SpringSensitivities& sensitivities,
                               const MeanShiftOptions& options = {});

}  // namespace equidem
