// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Report and JSON of `equidem solve`.
#pragma once

#include <span>

#include "problem.hpp"

namespace equidem {

/// Assembly, solver, and of each load case residual, energy, stress and, of the tension test, the moduli beside theory.
Results solve_results(const Problem& problem, const Effects& effects, std::span<const SolvedCase> results);

/// How much contacts deform, relative to the sum of their radii: forces over kN. A deformation that is hardly one is
/// questioned: units may be other ones than meant. \param forces one for each contact
void add_deformation(Results& out, const Problem& problem, std::span<const ContactForce> forces,
                     bool small_motions = true);

/// Strains, Poisson's ratio and Young's modulus of a tension test beside the theory of the lattice.
/// \param problem with its tension test
Results tension_results(const Problem& problem, const TensionResult& result);

}  // namespace equidem
