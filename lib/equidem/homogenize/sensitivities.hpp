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

/// The change of the stiffness where the springs of a contact grow by a common factor, over its change, Pa.
Matrix3 change_by_springs(const ContactSprings& springs, const SpringSensitivities& sensitivities, std::size_t contact);

/// Changes of the moduli (plane stress) by a change of the stiffness: EffectiveModuli linearized.
struct ModuliChange {
  double bulk_modulus_2d = 0, shear_modulus = 0, young_modulus = 0;
  double poisson_ratio = 0;
};
/// \param stiffness Pa, about which moduli change \param change of it
ModuliChange change_of_moduli(const Matrix3& stiffness, const Matrix3& change);

/// Standard deviations of the moduli over the coefficient of variation of the springs, to first order, where those of
/// each contact (kN, kT and kM by one factor) scatter independently.
ModuliChange scatter_of_moduli(const ContactSprings& springs, const Matrix3& stiffness,
                               const SpringSensitivities& sensitivities);

}  // namespace equidem
