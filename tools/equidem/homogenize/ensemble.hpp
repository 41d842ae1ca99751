// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// equidem homogenize of a case with [ensemble]: moduli of many random cells, their scatter, and the size they need.
#pragma once

#include "equidem/casefile/assembly/case.hpp"

#include "command.hpp"

namespace equidem {

/// Samples the cells of [ensemble] and delivers report, tables, plots and JSON.
/// \param resume keep the samples that lie in --out (option --resume of the verb), compute the others
/// \throws Error (bad_input) where the case has no periodic cell, or the samples in --out are of another case;
///         (computation_failed) where every sample is refused; (interrupted), with what is done kept in --out
void homogenize_ensemble(const CommonOptions& options, const Case& resolved, bool resume = false);

/// Random cells in the number and size that the accuracy requires, regardless of the sizes and numbers in the case; the
/// case that is written names those that were chosen.
/// \throws Error (bad_input) where the case has no periodic cells; (computation_failed) where the accuracy is beyond
///         all means; (interrupted)
void homogenize_to_accuracy(const CommonOptions& options, const Case& resolved, double accuracy);

}  // namespace equidem
