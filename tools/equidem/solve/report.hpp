// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The report of `equidem solve` for people.
#pragma once

#include <span>
#include <string>

#include "problem.hpp"

namespace equidem {

/// Title, assembly, springs, effects.
std::string describe_problem(const Problem& problem, const Effects& effects);

/// Unknowns, solver and what it says about the answer; then stress and, of the tension test, the moduli beside
/// theory, for each load case; then times.
std::string describe_results(const Problem& problem, std::span<const SolvedCase> results, const StageTimes& times);

/// Unknowns, memory and work of a computation that was not done.
std::string describe_estimate(const SolveEstimate& estimate);

/// "1 293 000" is easier to read than 1293000.
std::string grouped(std::int64_t value);

/// A line of a report: the name in a column of its own, the value broken into lines beside it.
std::string report_line(const std::string& name, const std::string& value);

}  // namespace equidem
