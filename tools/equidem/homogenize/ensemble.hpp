// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// equidem homogenize of a case with [ensemble]: moduli of many random cells, their scatter, and the size they need.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "equidem/casefile/assembly/case.hpp"
#include "equidem/homogenize/ensemble/ensemble.hpp"

#include "command.hpp"
#include "homogenize/ensemble_report.hpp"

namespace equidem {

/// Samples the cells of [ensemble] and delivers report, tables, plots and JSON.
/// \param resume keep the samples that lie in --out (option --resume of the verb), compute the others
/// \throws Error (bad_input) where the case has no periodic cell, or the samples in --out are of another case;
///         (computation_failed) where every sample is refused; (interrupted), with what is done kept in --out
int homogenize_ensemble(const CommonOptions& options, const Case& resolved, bool resume = false);

/// Random cells in the number and size that the accuracy requires, regardless of the sizes and numbers in the case; the
/// case that is written names those that were chosen.
/// \throws Error (bad_input) where the case has no periodic cells; (computation_failed) where the accuracy is beyond
///         all means; (interrupted)
int homogenize_to_accuracy(const CommonOptions& options, const Case& resolved, double accuracy);

// Shared by both.

/// The key and value that make a random assembly periodic.
const char* joins_sides(const AssemblyCase& assembly);

/// Builds and homogenizes one cell.
/// \throws Error as build_assembly and homogenize_cell
HomogenizedCell homogenize_cell(const Case& resolved, std::int64_t discs, std::uint64_t seed);

/// Title, cells, springs and effects; those of the first cell stand for all.
/// \param plan what is sampled, in words; empty: left out
Results cell_results(const Case& resolved, std::int64_t discs, std::uint64_t seed, const std::string& plan = {});

/// Writes samples, statistics and plots into --out, and delivers the results.
/// \param save_samples writes the table of the samples
/// \param failure as that of deliver
void deliver_ensemble(const CommonOptions& options, const EnsembleResult& result, Results results, StageTimes times,
                      const std::function<void()>& save_samples, const std::optional<Error>& failure);

/// \throws Error (bad_input) where a file of an ensemble could not be written
void check_ensemble_outputs(const CommonOptions& options);

}  // namespace equidem
