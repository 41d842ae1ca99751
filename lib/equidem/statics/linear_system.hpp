// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The linear equations of statics, K u = f, as sparse matrix and vectors for other solvers.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/contact/contact_springs.hpp"
#include "equidem/contact/effects.hpp"
#include "equidem/linear/contact_graph.hpp"
#include "equidem/linear/stiffness_matrix.hpp"
#include "equidem/statics/loads.hpp"
#include "equidem/statics/stiffness_solver.hpp"

namespace equidem {

/// K u = f over the components that are not held. Unknowns are u_x, u_y and a theta (a the mean radius), m; K is in Pa,
/// f in N/m.
struct LinearSystem {
  DegreesOfFreedom unknowns;        ///< all components, with those that are held and the motions prescribed there
  std::vector<std::int32_t> discs;  ///< number of each disc in the whole assembly; empty: none is left out
  CompressedColumns stiffness;      ///< lower triangle of K; `component` is that of each unknown
  std::vector<std::string> names;   ///< of the right-hand sides
  std::vector<std::vector<double>> right_hand_sides;  ///< f per unknown: loads less the forces of prescribed motions
  /// Per unknown: unit translations along x and y, m, and the rotation by 1 rad about the mean centre, m. They span the
  /// near-null space that algebraic multigrid needs; held components are cut out.
  std::array<std::vector<double>, 3> rigid_motions;

  [[nodiscard]] std::int64_t size() const { return stiffness.size; }
  /// The motion of each disc for a solution, prescribed motions included.
  /// \param solution per unknown, m
  [[nodiscard]] std::vector<DiscMotion> motions(std::span<const double> solution) const;
};

/// K and, for each right-hand side, f = loads - K u_0 - f_0, u_0 being the prescribed motion of held components and f_0
/// the forces by the mean strain, evaluated by the contact law in extended precision.
LinearSystem linear_system(const SpringNetwork& network, std::span<const RightHandSide> right_hand_sides);

/// The equations that EquilibriumSolver solves, without solving them; mechanisms are not looked for.
/// \throws Error (bad_input) as EquilibriumSolver does for supports and loads
LinearSystem equilibrium_system(const Assembly& assembly, const ContactSprings& springs,
                                std::span<const Support> supports, std::span<const LoadCase> loads,
                                Rotation rotation = Rotation::from_scene);

}  // namespace equidem
