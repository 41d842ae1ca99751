// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A case that was homogenized: the numbers of `equidem homogenize`.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "equidem/homogenize/effective_stiffness.hpp"
#include "equidem/homogenize/elasticity_tensor.hpp"
#include "equidem/homogenize/fabric.hpp"
#include "equidem/output/results.hpp"

#include "problem.hpp"

namespace equidem {

/// An estimate or a bound beside the stiffness.
struct StiffnessBeside {
  std::string key;   ///< in the JSON: "voigt", "uniform_stress_estimate", "displacement", "traction", "periodic"
  std::string name;  ///< in the table
  std::optional<Matrix3> stiffness;
  std::string missing;  ///< why there is none
};

/// Moduli by Abe (1996) for the springs of the case.
struct RelationBeside {
  std::string name;  ///< "mean field, eqs. (21), (22)"
  double bulk_modulus_2d = 0;
  double shear_modulus = 0;
};

/// The stiffness of the operator of the displacements, where rotation is restrained: div (C4 : grad u) of an isotropic
/// C4 is that of a body with G' = G + kappa and K' = K - kappa, kappa half of the stress s_xy - s_yx by a unit of
/// (u_x,y - u_y,x). On the hexagonal lattice these are the G' and K' of Abe 1996, eq. (53).
struct DisplacementOperator {
  double shear_modulus = 0;
  double bulk_modulus_2d = 0;
};
DisplacementOperator displacement_operator(const EffectiveStiffness& result);

struct Homogenized {
  const Problem& problem;
  EffectiveStiffness result;
  EffectiveModuli moduli;
  Fabric fabric;
  std::vector<StiffnessBeside> beside;
  std::optional<RelationBeside> relation;
  StageTimes times;

  /// "solved"; "unstable" where the assembly would give way; "unjudged" where the solver cannot tell.
  [[nodiscard]] std::string status() const {
    return result.unstable_modes > 0 ? "unstable" : result.unstable_modes < 0 ? "unjudged" : "solved";
  }
  /// Neighbours in the order traction <= periodic <= displacement <= Voigt that are known, lowest first. Empty where
  /// some kT < 0: energies are no minima then, and nothing is a bound.
  [[nodiscard]] std::vector<StiffnessBeside> ordered() const;
};

/// Variation of C11 with the direction of its axis, C11 + |two| cos 2(t - t2) + |four| cos 4(t - t4) about its mean.
struct StiffnessAxes {
  double one_axis = 0;        ///< amplitude over the mean: one axis is stiffer than the one across it
  double one_direction = 0;   ///< rad, of that axis, in [0, pi)
  double two_axes = 0;        ///< amplitude over the mean: two axes at right angles are stiffer than those between
  double two_directions = 0;  ///< rad, of the first of them, in [0, pi/2)
};
StiffnessAxes stiffness_axes(const Matrix3& stiffness);

/// Report and JSON of the verb.
Results homogenized_results(const Homogenized& homogenized);

}  // namespace equidem
