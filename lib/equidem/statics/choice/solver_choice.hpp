// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Choice of a factorization by the options of the user, and checks of its result.
#pragma once

#include <memory>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/contact/contact_springs.hpp"
#include "equidem/core/stopwatch.hpp"
#include "equidem/linear/factorization.hpp"
#include "equidem/linear/linear_solver.hpp"
#include "equidem/linear/multifrontal/front.hpp"
#include "equidem/linear/ordering/symbolic_factor.hpp"
#include "equidem/statics/number_unknowns.hpp"

namespace equidem {

/// Everything a factorization is made from.
struct System {
  const MatrixOnGraph& k;
  const ContactSprings& springs;
  const DegreesOfFreedom& unknowns;
  std::shared_ptr<const SymbolicFactor> symbolic;  ///< null for iterative methods
  int max_iterations = most_iterations;            ///< after which an iterative method gives up
  SolverOptions options = {};                      ///< settings that back ends use
};

/// The method that the options name; where they leave it to "auto", multigrid for many discs that form no narrow strip
/// and are solved for a few load cases: elsewhere elimination is about as fast and finds more, pivots and mechanisms.
SolverMethod choose_method(const Assembly& assembly, const ContactSprings& springs, const SolverOptions& options);

SolveEstimate estimate(const SymbolicFactor& symbolic, const DegreesOfFreedom& unknowns, bool indefinite);
/// Estimates the cost of an iterative method.
SolveEstimate estimate_iterations(const Assembly& assembly, const DegreesOfFreedom& unknowns);

/// \throws Error (computation_failed) where the estimated peak exceeds `memory_limit` bytes, or what the machine has
///         where it is 0
void check_memory(const SolveEstimate& estimate, double memory_limit);

/// Cholesky where no spring is negative, else L D L^T with delayed pivots, unless the user names a method. A
/// factorization that breaks down, or whose softest motion costs no energy, means a mechanism.
/// \throws Error (bad_input) naming the mechanism; (computation_failed) where the chosen method cannot factorize K, or
///         an apparent mechanism is none
std::unique_ptr<Factorization> factorize(const System& system, SolverMethod method, Mechanisms mechanisms,
                                         StageTimes& times);

/// A motion that elimination found to resist no more than round-off: a mechanism, or too soft for a double.
/// \throws Error (bad_input, computation_failed) that names it
[[noreturn]] void report_singular(const System& system, const std::vector<double>& softest);

/// Negative eigenvalues that the rotations bring by themselves: those of the rotational block of K (Haynsworth: the
/// inertia of K is that of this block and of the stiffness with rotations eliminated); -1 where the block is singular.
std::int64_t negative_rotations(const System& system);

}  // namespace equidem
