// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The head of a report as text.
#pragma once

#include "equidem/core/text.hpp"
#include "equidem/output/results.hpp"

#include "problem.hpp"

namespace equidem {

/// Title, assembly, springs, effects.
inline std::string describe_problem(const Problem& problem, const Effects& effects) {
  return problem_results(problem, effects).report();
}

}  // namespace equidem
