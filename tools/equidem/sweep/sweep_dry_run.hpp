// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Size of a sweep before it is made.
#pragma once

#include "equidem/output/results.hpp"

#include "sweep/sweep_run.hpp"

namespace equidem {

/// Delivers the number of points and the dry run of the first that can be computed.
/// \param results of the keys, which the others follow
/// \return the exit code
int dry_run_sweep(const Sweep& sweep, Results results);

}  // namespace equidem
