// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The complex stiffness of the continuum that an assembly with viscoelastic springs stands for, over frequency.
#pragma once

#include <complex>
#include <span>
#include <string>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/contact/contact_springs.hpp"
#include "equidem/core/matrix.hpp"
#include "equidem/core/stopwatch.hpp"
#include "equidem/homogenize/effective_stiffness.hpp"
#include "equidem/linear/linear_solver.hpp"
#include "equidem/material/viscoelasticity.hpp"

namespace equidem {

/// Stress over strain, both as exp(i omega t), without inertia: C = storage + i loss.
struct HarmonicStiffness {
  double frequency = 0;                     ///< Hz
  std::complex<double> normal, tangential;  ///< springs over the elastic ones
  /// Pa, symmetric part of the stress by strain (Voigt, engineering shear): C = 1/A sum kN dn_a dn_b + kT ds_a ds_b
  /// over the deformations by unit strains a and b, without conjugation, with the form of forces at rest where they
  /// count, and what leads from the nominal to the Cauchy stress, as EffectiveStiffness has it. It is stationary at the
  /// motions, so that its error is the square of theirs.
  Matrix3 storage{}, loss{};
  double relative_residual = 0;  ///< largest of the load cases
  double condition = 0;          ///< as that of EffectiveStiffness
  double error_bound = 0;        ///< Pa, on the modulus of the error of an entry, as that of EffectiveStiffness
};

/// The complex moduli of the nearest isotropic tensor, as EffectiveModuli.
struct HarmonicModuli {
  std::complex<double> bulk_modulus_2d, shear_modulus;  ///< K, G, Pa
  std::complex<double> poisson_strain, poisson_stress;  ///< nu = (K - G)/(2K), (K - G)/(K + G)
  std::complex<double> young_strain, young_stress;      ///< E = 2G(1 + nu), 4KG/(K + G), Pa
};
HarmonicModuli harmonic_moduli(const HarmonicStiffness& stiffness);

struct ViscoelasticStiffness {
  std::vector<HarmonicStiffness> harmonic;  ///< one for each frequency
  std::string solver;
  double factor_bytes = 0;
  StageTimes times;
};

/// Size of the complex factors of an assembly without supports.
SolveEstimate estimate_viscoelastic(const Assembly& assembly, const ContactSprings& springs, const Effects& effects);

/// Unit strains xx, yy and xy on one factorization for each frequency.
/// \param springs elastic; those of each contact times the factors of `viscoelasticity` are its complex springs
/// \param frequencies Hz, > 0
/// \param options boundary periodic or displacement
/// \throws Error as effective_stiffness; (bad_input) on negative springs, whose motions would grow, on forces at rest
///         of springs that do not keep them, on tractions at the boundary, frequencies that are not positive or outside
///         a table; (computation_failed) where the springs of a frequency are too far apart or forces at rest buckle;
///         ErrorWith<ViscoelasticStiffness> behind the first frequency
ViscoelasticStiffness viscoelastic_stiffness(const Assembly& assembly, const ContactSprings& springs,
                                             const Viscoelasticity& viscoelasticity,
                                             std::span<const double> frequencies,
                                             const HomogenizeOptions& options = {});

}  // namespace equidem
