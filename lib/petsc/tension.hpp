// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Abe's tension test on an assembly that the ranks share.
#pragma once

#include "equidem/assembly/lattices/row_lattice.hpp"
#include "equidem/homogenize/tension_test.hpp"

#include "petsc/equilibrium.hpp"

namespace equidem::petsc {

/// Loads, supports and gauges; the discs of the gauges by their names.
/// \param lattice of the assembly; null: the gauges are the discs nearest to the points wanted
/// \throws Error (bad_input) on all ranks, as equidem::tension_setup
TensionSetup tension_setup(const Ranks& ranks, const Part& part, const Whole& whole, const TensionTest& test,
                           const RowLattice* lattice);

TensionResult evaluate_tension(const Network& network, const TensionTest& test, const TensionSetup& setup,
                               const PartEquilibrium& equilibrium);

}  // namespace equidem::petsc
