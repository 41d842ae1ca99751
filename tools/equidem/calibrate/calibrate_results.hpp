// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Calibrated springs as a table of the parameters of other programs.
/// Report and JSON of strengths that were calibrated.
/// Report and JSON of `equidem calibrate`.
#pragma once

#include <optional>

#include "equidem/assembly/assembly.hpp"
#include "equidem/breakage/calibrate/calibrate_strength.hpp"
#include "equidem/contact/contact_springs.hpp"
#include "equidem/homogenize/calibrate/calibrate.hpp"
#include "equidem/output/results.hpp"

#include "problem.hpp"

namespace equidem {

/// LAMMPS, YADE and PFC, with units, depth and what does not hold. Without a table where springs differ from contact to
/// contact or kT is negative.
/// \param bond_width as BendingOptions, of springs that bend
Results engine_springs_results(const Assembly& assembly, const ContactSprings& springs, const SpringConstants& k,
                               std::optional<double> bond_width);

/// Tells of supports, loads and paths of the case, in whose place the tests stand.
void add_unused(Results& out, const Case& resolved);

/// Report and JSON.
/// \param first sample, whose width the report tells
Results strength_results(const Problem& problem, const StrengthSample& first, const StrengthCalibration& found);

/// \param problem its springs are those found
Results calibrated_results(const Problem& problem, const Calibration& found,
                           const std::optional<MeanFieldGuess>& guess);

/// The range of Poisson's ratio of an assembly that has not the one wanted.
Results feasible_results(const Problem& problem, const Calibration& range);

/// What was asked for is out of reach: `refusal`, and its line.
Results refusal_results(const Error& refusal);

}  // namespace equidem
