// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Plane elasticity tensors: isotropic part, moduli, anisotropy, order. All tensors here are symmetric, in Pa, rows and
/// columns in Voigt order (xx, yy, xy) with engineering shear strain.
#pragma once

#include <array>
#include <cstddef>

#include "equidem/core/matrix.hpp"
#include "equidem/material/elastic_moduli.hpp"
#include "equidem/material/spring_relations.hpp"

namespace equidem {

/// Adds form(r, c) to the entries 11, 12, 13, 22, 23, 33 of a symmetric 3 x 3 matrix.
template <typename Form>
void add_triangle(double* sums, const Form& form) {
  for (std::size_t r = 0; r < 3; ++r) {
    for (std::size_t c = r; c < 3; ++c) *sums++ += form(r, c);
  }
}
/// The matrix of these entries.
constexpr Matrix3 symmetric(const double* t) {
  return {{{t[0], t[1], t[2]}, {t[1], t[3], t[4]}, {t[2], t[4], t[5]}}};
}

/// The moduli of an effective stiffness. K, G, nu, E are those of the nearest isotropic tensor (the mean over
/// all directions), so that they do not depend on how the sample is turned.
struct EffectiveModuli {
  double bulk_modulus_2d = 0;  ///< K = (C11 + C22 + 2 C12)/4, Pa
  double shear_modulus = 0;    ///< G = (C11 + C22 - 2 C12 + 4 C66)/8, Pa
  double poisson_strain = 0;   ///< nu in plane strain, (K - G)/(2K)
  double poisson_stress = 0;   ///< nu in plane stress, (K - G)/(K + G)
  double young_strain = 0;     ///< E in plane strain, 2G(1 + nu), Pa
  double young_stress = 0;     ///< E in plane stress, 4KG/(K + G), Pa
  /// Distance from the nearest isotropic tensor over its size, |C - C_iso| / |C_iso|, in the norm of fourth-order
  /// tensors (Kelvin): the same for every direction of axes; 0: isotropic.
  double anisotropy = 0;
};

/// K and G of the nearest isotropic tensor, Pa: linear in the stiffness.
SheetModuli isotropic_part(const Matrix3& stiffness);
/// A sheet with G >= 3K gets its plane-strain numbers, too, although no solid has nu <= -1.
/// \param stiffness other than zero
EffectiveModuli effective_moduli(const Matrix3& stiffness);
/// C11 = C22 = K + G, C12 = K - G, C66 = G.
Matrix3 isotropic_stiffness(double bulk_modulus_2d, double shear_modulus);
/// The tensor seen from axes turned by `angle` (rad, counter-clockwise). A body turned by `angle` has, in fixed axes,
/// the stiffness rotated(C, -angle).
Matrix3 rotated(const Matrix3& stiffness, double angle);

/// Eigenvalues in the Kelvin basis (Pa, ascending) with their strains (Voigt, engineering shear, unit tensor norm):
/// the strain e_k meets the stress values[k] e_k. C = sum values[k] s_k s_k^T with s = (e_xx, e_yy, gamma/2) the strain
/// as a stress; C^-1 = sum e_k e_k^T / values[k].
struct StiffnessEigen {
  std::array<double, 3> values;
  Matrix3 strains;  ///< row k belongs to values[k]
};
StiffnessEigen eigenstrains(const Matrix3& stiffness);

/// C^-1, 1/Pa: strain with engineering shear by stress.
/// \throws Error (computation_failed) where C is singular: an eigenvalue within round-off of zero
Matrix3 inverse(const Matrix3& stiffness);
/// Direction of the largest value of a cos k t + b sin k t, rad in [0, 2 pi/k), k the harmonic.
double harmonic_direction(double a, double b, int harmonic);
/// Variation of C11 with the direction of its axis, C11 + |two| cos 2(t - t2) + |four| cos 4(t - t4) about its mean.
struct StiffnessAxes {
  double one_axis = 0;        ///< amplitude over the mean: one axis is stiffer than the one across it
  double one_direction = 0;   ///< rad, of that axis, in [0, pi)
  double two_axes = 0;        ///< amplitude over the mean: two axes at right angles are stiffer than those between
  double two_directions = 0;  ///< rad, of the first of them, in [0, pi/2)
};
StiffnessAxes stiffness_axes(const Matrix3& stiffness);

/// Smallest eigenvalue of b - a over the largest of b: not negative where a <= b as quadratic forms, but for round-off.
/// \param b positive for some strain
double margin(const Matrix3& a, const Matrix3& b);

}  // namespace equidem
