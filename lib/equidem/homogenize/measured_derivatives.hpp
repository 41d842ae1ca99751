// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Derivatives by springs of what is measured of an equilibrium: one more solution for each number, with the factor
/// that there is.
#pragma once

#include <string>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/homogenize/tension_test.hpp"
#include "equidem/statics/adjoint.hpp"
#include "equidem/statics/equilibrium.hpp"

namespace equidem {

/// A number of an equilibrium with its derivatives by the springs.
struct MeasuredNumber : SpringDerivatives {
  std::string symbol;  ///< "right_ux", "stress_xx", "E", "nu"
  double value = 0;
  double scale = 1;  ///< of the size of the number, > 0: what its change is relative to
};

/// The mean displacements ux and uy of each group that loads act on, m, where supports do not hold them, and the mean
/// stress, Pa, where the assembly has cell areas.
/// \param state of this solver under the loads
/// \throws Error as derivatives() of adjoint.hpp
std::vector<MeasuredNumber> displacement_derivatives(EquilibriumSolver& solver, const Equilibrium& state,
                                                     const LoadCase& loads);
std::vector<MeasuredNumber> stress_derivatives(EquilibriumSolver& solver, const Equilibrium& state);

/// Young's modulus E, Pa, and Poisson's ratio nu in plane stress from the strains of the gauges.
std::vector<MeasuredNumber> tension_derivatives(EquilibriumSolver& solver, const Equilibrium& state,
                                                const TensionTest& test, const TensionSetup& setup);

}  // namespace equidem
