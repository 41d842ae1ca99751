// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Size and time of a sweep before it is made.
#pragma once

#include "equidem/output/results.hpp"

#include "sweep/sweep_run.hpp"

namespace equidem {

/// Delivers the dry run of a point and the time of all, which follows from the dry runs of some of them.
/// \param results of the keys, which the others follow
/// \return the exit code
int dry_run_sweep(const Sweep& sweep, Results results);

}  // namespace equidem
