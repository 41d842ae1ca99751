// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Report and JSON of `equidem solve`.
#pragma once

#include <span>

#include "command.hpp"
#include "problem.hpp"
#include "spring_effects.hpp"

namespace equidem {

/// Solver, and of each load case residual, energy, stress and, of the tension test, the moduli beside theory.
/// \param of_problem results of the problem, which come first
/// \param by_springs numbers of each load case that depend on springs; empty: not asked for
Results solve_results(const Problem& problem, Results of_problem, std::span<const SolvedCase> results,
                      std::span<const std::vector<SpringDependent>> by_springs = {});

/// How much contacts deform. A deformation that is hardly one is questioned: units may be other ones than meant.
void add_deformation(Results& out, const LargestDeformation& deformation, bool small_motions);

/// Strains, Poisson's ratio and Young's modulus of a tension test beside the theory of the lattice.
/// \param problem with its tension test
Results tension_results(const Problem& problem, const TensionResult& result);

}  // namespace equidem
