// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Equilibrium of an assembly under supports and loads, by solving its assembled stiffness matrix.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/contact/contact_springs.hpp"
#include "equidem/contact/effects.hpp"
#include "equidem/contact/frame.hpp"
#include "equidem/core/stopwatch.hpp"
#include "equidem/linear/linear_solver.hpp"
#include "equidem/statics/loads.hpp"
#include "equidem/statics/rigidity.hpp"
#include "equidem/statics/stiffness_solver.hpp"

namespace equidem {

/// Force and moment by which a support holds a disc.
struct Reaction {
  std::int32_t disc = 0;
  Vec2 force;         ///< N/m
  double moment = 0;  ///< N
};

/// The state of rest of one load case, with measures of its accuracy.
struct Equilibrium : SolverFindings {
  std::vector<DiscMotion> motions;           ///< per disc
  std::vector<ContactForce> contact_forces;  ///< per contact; beside those at rest, along n and s of before the motion
  /// N, per contact where bending springs count, else empty: on the first disc; its negative acts on the second.
  std::vector<double> bending_moments;
  std::vector<Reaction> reactions;       ///< discs with a held component
  std::vector<double> rotation_moments;  ///< N, per disc: moment that holds it where rotation is restrained; else empty
  /// |f - K u| over |f| (prescribed motions included in f), 2-norms over the unknowns, for the motion u that refinement
  /// keeps to twice the digits of a double: the residual of the contact forces.
  double relative_residual = 0;
  double rounded_residual = 0;  ///< the same for `motions`, which are u rounded to doubles
  int refinements = 0;          ///< steps of iterative refinement done
  /// |K| |K^-1|, estimated (2-norm of the inverse by inverse iteration from the solution), and the bound on the
  /// relative error of `motions` (2-norm) that follows from it, the residual and the rounding of normals, with a margin
  /// of 10; 0 unless asked for.
  /// Where iterations ended at SolverOptions::accuracy, the estimated error in the norm of energy takes the place of
  /// the bound.
  double condition = 0;
  double error_bound = 0;
  std::string first_mechanism;  ///< description; empty where there is none
  StageTimes times;             ///< assembly of K, ordering, analysis, factorization, solve, refinement, ...

  /// Total elastic energy, N (J/m per m); of prestressed contacts its part of second order in the motion.
  double energy = 0;
  /// A report of a few lines.
  [[nodiscard]] std::string report() const;
};

struct EquilibriumOptions {
  Rotation rotation = Rotation::from_scene;
  SolverOptions solver;
  bool error_bound = false;  ///< estimate the condition of K: two more solves
  /// hold: up to 1000 mechanisms stay as they are where no load does work on them
  Mechanisms mechanisms = Mechanisms::refuse;
};

/// A factorized stiffness matrix of an assembly with its supports: any number of load cases, one factorization. One
/// thread at a time may solve.
class EquilibriumSolver {
 public:
  /// Decide the unknowns, check the supports, assemble K, order, analyze and factorize. The assembly and the springs
  /// must outlive this object.
  /// \throws Error (bad_input) on discs without contacts, an assembly in pieces of which some can move freely, a
  ///         rigid motion that the supports leave free (named), a mechanism (named); Error (computation_failed) where
  ///         K is singular, (out_of_memory) where the factor would not fit
  EquilibriumSolver(const Assembly& assembly, const ContactSprings& springs, std::span<const Support> supports,
                    const EquilibriumOptions& options = {});
  ~EquilibriumSolver();
  EquilibriumSolver(EquilibriumSolver&&) noexcept;
  EquilibriumSolver& operator=(EquilibriumSolver&&) noexcept;
  EquilibriumSolver(const EquilibriumSolver&) = delete;
  EquilibriumSolver& operator=(const EquilibriumSolver&) = delete;

  /// A load on a component that is held goes straight into its reaction.
  /// \throws Error (bad_input) where a load names no group or an empty one, or gives a moment to a disc that nothing
  ///         keeps from turning; Error (computation_failed) where the residual shows that K is too near to singular
  [[nodiscard]] Equilibrium solve(const LoadCase& loads);
  /// \param loads one for each disc
  /// \throws Error (bad_input) likewise, and where there are more or fewer loads than discs
  [[nodiscard]] Equilibrium solve(std::span<const DiscForce> loads);
  /// Likewise, with supports that do not move.
  [[nodiscard]] Equilibrium solve_held(std::span<const DiscForce> loads);
  [[nodiscard]] const Assembly& assembly() const;
  [[nodiscard]] const ContactSprings& springs() const;
  [[nodiscard]] const Effects& effects() const;
  [[nodiscard]] std::int64_t unknowns() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

/// Order and analyze, without assembling or factorizing: what a solve will take.
/// \param indefinite by L D L^T, whatever the springs
/// \throws Error (bad_input) as EquilibriumSolver does for supports
SolveEstimate estimate_solve(const Assembly& assembly, const ContactSprings& springs, std::span<const Support> supports,
                             const EquilibriumOptions& options = {}, bool indefinite = false);

/// One load case.
Equilibrium solve_equilibrium(const Assembly& assembly, const ContactSprings& springs,
                              std::span<const Support> supports, const LoadCase& loads,
                              const EquilibriumOptions& options = {});

}  // namespace equidem
