// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The effective stiffness of a periodic cell that the ranks share.
#pragma once

#include "equidem/homogenize/effective_stiffness.hpp"

#include "petsc/solver.hpp"

namespace equidem::petsc {

/// The components to hold of a lattice or a triangulation: the translations of the first disc, and its rotation where
/// all discs of a square lattice can turn like gears.
std::vector<std::int64_t> free_components(const Part& part, const Effects& effects);

class CellSolver {
 public:
  /// All arguments but the last must outlive this object and not move.
  /// \param held components that stop motions which no mean strain drives, as Network::hold; see free_components
  /// \throws Error (bad_input) on all ranks where the assembly is not periodic
  CellSolver(const Ranks& ranks, const Part& part, const Whole& whole, const ContactSprings& springs,
             const Effects& effects, SolverMethod method, std::span<const std::int64_t> held);

  /// Unit strains xx, yy, xy, and the unit rotation where rotation is restrained. `fluctuations` are those of the part.
  /// \throws Error on all ranks: the network has a mean strain without energy, passes do not converge
  [[nodiscard]] EffectiveStiffness solve();
  [[nodiscard]] const Network& network() const { return network_; }

 private:
  const Effects& effects_;
  StageTimes times_;
  Network network_;
  std::optional<PetscSolver> solver_;
};

}  // namespace equidem::petsc
