// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The stiffness matrix of all ranks and its solution by PETSc. Options with the prefix -equidem_ decide about both.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <petscksp.h>

#include "equidem/core/stopwatch.hpp"
#include "equidem/core/vector.hpp"
#include "equidem/linear/linear_solver.hpp"
#include "equidem/statics/internal_force.hpp"

#include "petsc/network.hpp"

namespace equidem::petsc {

/// The rows of K by PETSc: conjugate gradients with its multigrid of aggregates (GAMG) where no spring is negative,
/// else MUMPS. A method of the case that eliminates means MUMPS, multigrid GAMG.
class PetscSolver {
 public:
  /// Assembles K and sets the solver up. Held components have rows of the unit matrix times a spring.
  /// \throws Error on all ranks
  PetscSolver(const Network& network, SolverMethod method, StageTimes& times);
  ~PetscSolver();
  PetscSolver(const PetscSolver&) = delete;
  PetscSolver& operator=(const PetscSolver&) = delete;

  /// K d = r up to the tolerance of the solver, -equidem_ksp_rtol.
  /// \param r per component; of owned discs
  /// \param d likewise, with those of ghosts
  /// \return iterations
  /// \throws Error (computation_failed) on all ranks where the solver does not converge; (interrupted)
  std::int64_t solve(std::span<const double> r, std::span<double> d);

  /// "PETSc 3.18.5: cg, gamg on 2 ranks".
  [[nodiscard]] std::string name() const;
  /// Of all ranks; 0: not known.
  [[nodiscard]] double grid_bytes() const;

 private:
  struct Interruption;

  void assemble();
  void set_near_null_space();
  void set_up(SolverMethod method);

  const Network& network_;
  Interruption* interruption_ = nullptr;
  Mat matrix_ = nullptr;
  Vec load_ = nullptr, solution_ = nullptr;
  KSP solver_ = nullptr;
};

struct Refined {
  PreciseMotion motion{0};  ///< per component, with those of ghosts
  double scale = 0;         ///< |f - K u| for the prescribed motion alone, N/m
  double residual = 0;      ///< |f - K u|, N/m
  double rounded_residual = 0;
  int refinements = 0;  ///< passes after the first
  std::int64_t iterations = 0;
  /// The change of the motion that a further pass would bring, relative (2-norms): the last change times the ratio of
  /// the last two.
  double error = 0;
};

/// \param f per component, 0 for ghosts; empty: no load
/// \param gradient of the mean displacement
/// \throws Error (computation_failed) on all ranks where passes do not converge
Refined refine(const Network& network, PetscSolver& solver, std::span<const double> f,
               const std::optional<Tensor2>& gradient);

/// Messages, bytes and sums over all ranks that this rank took part in since the program began, counted by PETSc.
struct Counted {
  double messages = 0, bytes = 0, sums = 0;
};
Counted counted_messages();

/// The options of the command line that nothing asked for, as they were given; none before a solver has read its own.
std::vector<std::string> unused_options();

}  // namespace equidem::petsc
