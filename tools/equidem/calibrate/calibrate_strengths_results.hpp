// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Report and JSON of strengths that were calibrated.
#pragma once

#include "equidem/breakage/calibrate/calibrate_strength.hpp"

#include "problem.hpp"

namespace equidem {

/// Tells of supports, loads and paths of the case, in whose place the tests stand.
void add_unused(Results& out, const Case& resolved);

/// Report and JSON.
/// \param first sample, whose width the report tells
Results strength_results(const Problem& problem, const StrengthSample& first, const StrengthCalibration& found);

}  // namespace equidem
