// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// What the ranks solve together: equilibrium under supports and loads, Abe's tension test, the effective stiffness of
/// a periodic cell.
#pragma once

#include <cstdint>
#include <vector>

#include "equidem/assembly/lattices/row_lattice.hpp"
#include "equidem/homogenize/effective_stiffness.hpp"
#include "equidem/homogenize/tension_test.hpp"
#include "equidem/statics/equilibrium.hpp"

#include "petsc/solver.hpp"

namespace equidem::petsc {

/// The numbers are those of the whole, the same on all ranks; motions and forces those of the part.
struct PartEquilibrium {
  Equilibrium state;
  Tensor2 stress;                  ///< Pa, mean; 0 where the area is not known
  double moment_per_area = 0;      ///< Pa
  double stress_scale = 0;         ///< Pa
  double largest_deformation = 0;  ///< of a contact, over the sum of its radii
};

/// \throws Error on all ranks, as EquilibriumSolver::solve where it does not need the whole assembly for it
PartEquilibrium solve_loads(const Network& network, PetscSolver& solver, const LoadCase& loads);

/// Loads, supports and gauges; the discs of the gauges by their names.
/// \param lattice of the assembly; null: the gauges are the discs nearest to the points wanted
/// \throws Error (bad_input) on all ranks, as equidem::tension_setup
TensionSetup tension_setup(const Ranks& ranks, const Part& part, const Whole& whole, const TensionTest& test,
                           const RowLattice* lattice);

TensionResult evaluate_tension(const Network& network, const TensionTest& test, const TensionSetup& setup,
                               const PartEquilibrium& equilibrium);

/// The components to hold of a lattice or a triangulation: the translations of the first disc, and its rotation where
/// all discs of a square lattice can turn like gears.
std::vector<std::int64_t> free_components(const Part& part, const Effects& effects);

/// Unit strains xx, yy, xy, and the unit rotation where rotation is restrained. `fluctuations` are those of the part.
/// \param network without supports; it holds what no mean strain drives, see free_components
/// \throws Error on all ranks: the assembly is not periodic, has a mean strain without energy, passes do not converge
EffectiveStiffness cell_stiffness(const Network& network, PetscSolver& solver);

}  // namespace equidem::petsc
