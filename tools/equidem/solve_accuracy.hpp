// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// --accuracy of `equidem solve`: the size of the block of a tension test, or the bound of the solver.
#pragma once

#include <optional>

#include "accuracy.hpp"
#include "command.hpp"
#include "problem.hpp"

namespace equidem {

/// A tension test of a lattice misses the lattice without sides by about one over its rows. Choose the rows and columns, in the proportion
/// of the case, for which nu, and the stiffness ratio (36) relative to itself, are within the accuracy, and add them to options.set.
/// Sides of whole fours and one disc: gauges then sit alike in all. Empty where the case is no such test: nothing is chosen.
/// \throws Error (computation_failed) where that takes more than a million discs, or errors do not fall as one over the rows
std::optional<ReachedAccuracy> choose_block(CommonOptions& options, double accuracy);

/// What the answer to an assembly that is given owes to the solver: its error bound.
/// \throws Error (computation_failed) where the bound is above the accuracy, or not known
ReachedAccuracy solver_accuracy(double accuracy, double error_bound, double condition, double seconds);

}  // namespace equidem
