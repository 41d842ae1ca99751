// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Report and JSON of `equidem calibrate`.
#pragma once

#include <optional>

#include "equidem/homogenize/calibrate/calibrate.hpp"

#include "problem.hpp"

namespace equidem {

/// \param problem its springs are those found
Results calibrated_results(const Problem& problem, const Calibration& found,
                           const std::optional<MeanFieldGuess>& guess);

/// The range of Poisson's ratio of an assembly that has not the one wanted.
Results feasible_results(const Problem& problem, const Calibration& range);

/// What was asked for is out of reach: `refusal`, and its line.
Results refusal_results(const Error& refusal);

}  // namespace equidem
