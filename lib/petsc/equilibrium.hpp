// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Equilibrium of an assembly that the ranks share, under supports and loads, and Abe's tension test on it.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "equidem/assembly/lattices/row_lattice.hpp"
#include "equidem/homogenize/tension_test.hpp"
#include "equidem/statics/equilibrium.hpp"

#include "petsc/solver.hpp"

namespace equidem::petsc {

/// The numbers are those of the whole, the same on all ranks; motions and forces those of the part.
struct PartEquilibrium {
  Equilibrium state;
  Tensor2 stress;                  ///< Pa, mean; 0 where the area is not known
  double moment_per_area = 0;      ///< Pa
  double largest_deformation = 0;  ///< of a contact, over the sum of its radii
};

class PartSolver {
 public:
  /// All arguments must outlive this object and not move.
  /// \param known_to_be_held no motion without energy is left: check_rigidity has seen the whole
  /// \throws Error on all ranks, as EquilibriumSolver where it does not need the whole assembly for it
  PartSolver(const Ranks& ranks, const Part& part, const Whole& whole, const ContactSprings& springs,
             const Effects& effects, std::span<const Support> supports, SolverMethod method, bool known_to_be_held);

  [[nodiscard]] PartEquilibrium solve(const LoadCase& loads);
  [[nodiscard]] const Network& network() const { return network_; }

 private:
  [[nodiscard]] std::vector<double> assemble(const LoadCase& loads) const;
  void describe(const LoadCase& loads, std::span<const double> f, const Refined& refined, PartEquilibrium& result);

  StageTimes times_;
  const Effects& effects_;
  Network network_;
  std::optional<PetscSolver> solver_;
};

/// Loads, supports and gauges; the discs of the gauges by their names.
/// \param lattice of the assembly; null: the gauges are the discs nearest to the points wanted
/// \throws Error (bad_input) on all ranks, as equidem::tension_setup
TensionSetup tension_setup(const Ranks& ranks, const Part& part, const Whole& whole, const TensionTest& test,
                           const RowLattice* lattice);

TensionResult evaluate_tension(const Network& network, const TensionTest& test, const TensionSetup& setup,
                               const PartEquilibrium& equilibrium);

}  // namespace equidem::petsc
