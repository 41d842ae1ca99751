// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Passes of the solver of PETSc, each with the residual of the contact law of the motion found so far.
#pragma once

#include <optional>
#include <span>

#include "equidem/core/vector.hpp"
#include "equidem/statics/internal_force.hpp"

#include "petsc/solver.hpp"

namespace equidem::petsc {

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

}  // namespace equidem::petsc
