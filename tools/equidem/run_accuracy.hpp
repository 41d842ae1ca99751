// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// --accuracy of `equidem run`: the time step.
#pragma once

#include "accuracy.hpp"
#include "command.hpp"

namespace equidem {

/// Make the run with the step of the case, its half and its quarter (and finer ones, until the motions at the end converge by the order of
/// the integrator); choose the longest step for which the displacements at the end are within the accuracy, relative to the largest
/// one, and add it to options.set.
/// \throws Error (bad_input) where the run goes to rest; (computation_failed) where no step reaches it, or motions do not converge
ReachedAccuracy choose_step(CommonOptions& options, double accuracy);

}  // namespace equidem
