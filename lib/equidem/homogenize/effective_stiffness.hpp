// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The stiffness of the continuum that an assembly stands for: all load cases on one factorization.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/contact/contact_springs.hpp"
#include "equidem/contact/effects.hpp"
#include "equidem/contact/frame.hpp"
#include "equidem/core/matrix.hpp"
#include "equidem/core/stopwatch.hpp"
#include "equidem/homogenize/boundary.hpp"
#include "equidem/linear/linear_solver.hpp"
#include "equidem/statics/stiffness_solver.hpp"

namespace equidem {

struct HomogenizeOptions {
  Boundary boundary = Boundary::periodic;
  Rotation rotation = Rotation::from_scene;
  SolverOptions solver = {};
};

/// A motion without energy that leaves the effective stiffness unchanged.
struct ZeroEnergyMode {
  std::string kind;         ///< "gear", "mode"
  std::string description;  ///< which discs, which motion
};

/// Effective stiffness with measures of its accuracy.
struct EffectiveStiffness : SolverFindings {
  Boundary boundary = Boundary::periodic;
  double area = 0;  ///< m², by which energies are divided
  /// Pa, symmetric part of the stress by strain (Voigt, engineering shear), from the energies of the load cases:
  /// its error is the square of that of the motions.
  Matrix3 stiffness{};
  /// Pa, dC/dkT times kT, dC/dkN times kN and dC/dkM times kM (they add up to C): the strain energies in tangential,
  /// normal and bending springs. Exact derivatives for springs scaled by a common factor, since the motion is
  /// stationary.
  Matrix3 tangential_part{};
  Matrix3 normal_part{};
  Matrix3 bending_part{};
  /// Pa, what the forces at rest add: their part of the energies and the change of the stress by the change of shape
  /// (`stiffness` is the symmetric part of `cauchy`); 0 without prestress.
  Matrix3 prestress_part{};
  /// Pa, derivative of the Cauchy stress by the mean strain (Voigt, engineering shear), no mean rotation: the
  /// stress-strain coefficients of Barron & Klein 1965 (Proc. Phys. Soc. 85, 523). Under a stress at rest that is not
  /// isotropic it is not symmetric. Where nothing is prestressed it is `stiffness`.
  Matrix3 cauchy{};
  Tensor2 stress_at_rest;  ///< Pa, of the forces at rest where they count
  /// Pa, Love-Weber stress (1/A) sum F_i l_j by displacement gradient, with A and l of before the strain (the nominal
  /// stress where there are forces at rest). Without them and with free rotation columns xy and yx agree, and
  /// so do the rows; with rotation restrained neither need (Abe 1996, eq. 55). Only for Boundary::periodic and
  /// displacement.
  Matrix4 gradient_stiffness{};
  double stress_asymmetry = 0;  ///< largest |s_xy - s_yx| of any unit gradient over the largest entry

  double relative_residual = 0;  ///< largest of the load cases
  /// Estimate of |K| |K^-1|, each component measured by the stiffness of its row; 0 where the method is iterative.
  double condition = 0;
  /// Pa: bound on the error of an entry of `stiffness`, from residual and condition, or as estimated from the
  /// iterations, and (but for tractions) from rounding of normals and lever arms; centres, period and springs are taken
  /// as the exact numbers that they are given as.
  double error_bound = 0;
  double hill_mandel = 0;  ///< largest |macroscopic - microscopic power| over the latter

  std::int64_t rattlers = 0;            ///< discs without contacts, left out
  std::int64_t discs_removed = 0;       ///< that carry no load: rattlers, dangling discs, floating pieces
  std::vector<std::string> removed;     ///< sentences that name them
  std::vector<ZeroEnergyMode> motions;  ///< held, since they do not change the stiffness; at most a few are described
  std::int64_t gear_modes = 0;
  /// Independent states of self-stress (Maxwell & Calladine); none: not counted.
  std::optional<std::int64_t> self_stresses = 0;
  Effects effects;
  /// Negative eigenvalues of `stiffness`, which count as unstable modes too.
  std::int64_t unstable_strains = 0;
  StageTimes times;
  /// Motion of every disc for unit strain xx, yy, xy beside the uniform strain, m; discs removed stand still. Empty for
  /// tractions.
  std::vector<std::vector<DiscMotion>> fluctuations;

  /// All springs `factor` times as stiff: the motions stay.
  void scale(double factor);
  /// Counts the mean strains that release energy, as unstable modes too.
  /// \param nothing an energy below this share of the largest, or within the error bound, is none
  /// \return "the mean strain (xx 0.707, yy -0.707, shear 0.000)" of one that costs none, where there is one
  std::optional<std::string> judge_strains(double nothing = 1e-13);
};

/// Solve for unit strains xx, yy and xy (and the unit rotation where rotation is restrained) on one factorization.
/// \throws Error (bad_input) where the boundary does not suit the assembly, levers do not add up to their branch where
///         they matter, no piece spans the cell, the network is a mechanism (named) or some strain has no energy
///         (named), since a floppy network has no modulus; springs too far apart for a double; (computation_failed) as
///         EquilibriumSolver; at the limit of stability
EffectiveStiffness effective_stiffness(const Assembly& assembly, const ContactSprings& springs,
                                       const HomogenizeOptions& options = {});

/// The stiffness of the operator of the displacements, where rotation is restrained: div (C4 : grad u) of an isotropic
/// C4 is that of a body with G' = G + kappa and K' = K - kappa, kappa half of the stress s_xy - s_yx by a unit of
/// (u_x,y - u_y,x). On the hexagonal lattice these are the G' and K' of Abe 1996, eq. (53).
struct DisplacementOperator {
  double shear_modulus = 0;
  double bulk_modulus_2d = 0;
};
DisplacementOperator displacement_operator(const EffectiveStiffness& result);

/// The assembly under one mean strain.
struct StrainedState {
  Tensor2 gradient;                      ///< of the mean displacement
  std::vector<DiscMotion> fluctuations;  ///< per disc, beside it
  std::vector<ContactForce> forces;      ///< per contact; 0 where no load is carried
  std::vector<double> bending_moments;   ///< N, per contact, on its first disc; empty where contacts carry none
};
/// The states of the mean strains xx, yy and xy, each of the size `strain` (xy: engineering shear strain).
/// \param result of the same assembly and springs; one of tractions has no states
std::vector<StrainedState> strained_states(const Assembly& assembly, const ContactSprings& springs,
                                           const EffectiveStiffness& result, double strain);

}  // namespace equidem
