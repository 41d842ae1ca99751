// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A factor in single precision as preconditioner of refinement, and when it serves.
///
/// It takes half the memory and half the time of one in double precision. Each pass of refinement with it brings about
/// three digits, as long as the round-off of a float times the condition of K is below 1.
#pragma once

#include <memory>
#include <string>

#include "equidem/linear/factorization.hpp"
#include "equidem/statics/choice/solver_choice.hpp"

namespace equidem {

/// Whether single precision is tried: by the wish of the user or, where that is left to the program, for factors so
/// large that it pays. Never where a spring is negative, or without refinement.
bool tries_single_precision(const SolverOptions& options, const ContactSprings& springs,
                            const SymbolicFactor& symbolic);

/// Null, with the reason, where stiffnesses lie too far apart for one norm of the residual to judge them all, or
/// elimination met a pivot that round-off of a float may have made.
std::unique_ptr<Factorization> factorize_in_single_precision(const System& system, std::string& reason);

}  // namespace equidem
