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

}  // namespace equidem
