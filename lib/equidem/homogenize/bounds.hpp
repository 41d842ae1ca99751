// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The effective stiffness beside its bounds and estimates.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/contact/contact_springs.hpp"
#include "equidem/core/matrix.hpp"
#include "equidem/core/names.hpp"
#include "equidem/core/vector.hpp"
#include "equidem/homogenize/effective_stiffness.hpp"

namespace equidem {

/// Directional measures of a contact network. Anisotropies are amplitudes of the harmonics of psi(theta) over its mean
/// (contact_harmonics): 0 where no direction is preferred, 2 where all contacts have it; at 0 the direction means
/// nothing.
struct Fabric {
  Tensor2 normal;           ///< <n n>, trace 1 (Satake 1982)
  Tensor2 branch;           ///< (1/A) sum l l^T, dimensionless: its trace is S of the Voigt stiffness
  double anisotropy_2 = 0;  ///< sqrt(a_2² + b_2²): how much one axis is preferred
  double direction_2 = 0;   ///< rad, of that axis, in [0, pi)
  double anisotropy_4 = 0;  ///< sqrt(a_4² + b_4²): how much two axes at right angles are
  double direction_4 = 0;   ///< rad, of the first of them, in [0, pi/2)
  double mean_branch = 0;   ///< m
};

/// \throws Error (bad_input) where there are no contacts, or a free assembly has no cell areas
Fabric fabric(const Assembly& assembly);

/// Every disc follows the uniform strain (and the mean rotation, which a strain has none of): C_V = (1/A) sum kN d_n
/// d_n + kT d_s d_s over contacts, with the deformations of unit strains; an upper bound as a quadratic form where
/// kT >= 0 (Bathurst & Rothenburg 1988). Springs equal at all contacts give effective_moduli K = S kN/4 and
/// G = S (kN + kT)/8 with S = sum l²/A, for any fabric. Exact on lattices with one disc in the primitive cell. Pa.
/// \throws Error (bad_input) where a free assembly has no cell areas
Matrix3 voigt_stiffness(const Assembly& assembly, const ContactSprings& springs);

/// Every contact carries its share of a uniform stress, F = A sigma B^-1 l with B = sum l l^T, whose Love-Weber stress
/// is sigma: C = (compliance of those forces)^-1 (Liao et al. 1997, Kruyt & Rothenburg 2002). An estimate, no lower
/// bound, since forces do not balance on a disc; never above C_V, since the forces do the work A sigma : e along every
/// strain e (Cauchy-Schwarz). For isotropic assemblies of equal springs K = S kN/4, G = (S/2) kN kT/(kN + kT). Pa.
///
/// Where springs are absent (kT = 0) this is the limit kT -> 0: no stress that loads them is resisted. What is left is
/// at least the stress sigma = B/A, whose forces F = l load no tangential spring: for isotropic assemblies K without G.
/// \throws Error (bad_input) where some kT < 0, or kT = 0 off the lines of centres, there are no contacts, their
///         branches do not span the plane, or a free assembly has no cell areas
Matrix3 uniform_stress_estimate(const Assembly& assembly, const ContactSprings& springs);

/// Bounds that are found with the effective stiffness.
enum class BoundsWanted {
  automatic,  ///< all up to most_discs_of_bounds discs where no kT < 0, else affine
  affine,     ///< those that need no solution
  all,        ///< also those by uniform displacements and tractions at the boundary
};

template <>
struct EnumNames<BoundsWanted> {
  static constexpr const char* what = "choice of bounds";
  static constexpr NamedValue<BoundsWanted> list[] = {
      {BoundsWanted::automatic, "auto"}, {BoundsWanted::affine, "affine"}, {BoundsWanted::all, "all"}};
};

inline constexpr std::size_t most_discs_of_bounds = 20000;

struct BoundsOptions {
  /// Boundary of the result; none: periodic where the assembly is, else displacement with traction beside it.
  std::optional<Boundary> boundary = {};
  BoundsWanted bounds = BoundsWanted::automatic;
  Rotation rotation = Rotation::from_scene;
  SolverOptions solver = {};
};

/// An estimate or a bound beside the stiffness.
struct StiffnessBeside {
  std::string key;  ///< "voigt", "uniform_stress_estimate", or the name of a Boundary
  std::optional<Matrix3> stiffness;
  std::string missing;  ///< why there is none
};

struct BoundedStiffness {
  EffectiveStiffness result;
  std::vector<StiffnessBeside> beside;

  /// Those known of traction <= periodic <= displacement <= Voigt, lowest first. Empty where some kT < 0: energies are
  /// no minima then, and nothing is a bound.
  [[nodiscard]] std::vector<StiffnessBeside> ordered(const ContactSprings& springs) const;
};

/// The boundaries that bounded_stiffness solves with, that of the result first.
std::vector<Boundary> boundaries_of(const Assembly& assembly, const ContactSprings& springs,
                                    const BoundsOptions& options);

/// \throws Error as effective_stiffness of the first boundary; a bound that cannot be found says why;
///         ErrorWith<BoundedStiffness> where the user asked to stop behind it
BoundedStiffness bounded_stiffness(const Assembly& assembly, const ContactSprings& springs,
                                   const BoundsOptions& options = {});

}  // namespace equidem
