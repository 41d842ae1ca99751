// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Report, JSON, tables and plots of `equidem stability`.
#pragma once

#include <filesystem>

#include "equidem/output/results.hpp"
#include "equidem/waves/stability.hpp"

#include "command.hpp"
#include "problem.hpp"

namespace equidem {

/// Report and JSON of the verb.
Results stability_results(const Problem& problem, const Stability& stability);

/// \name Tables and plots of the survey. \{
void write_survey(const std::filesystem::path& folder, const std::string& title, const Stability& stability,
                  bool overwrite);
/// \throws Error (bad_input) where a file of write_survey could not be written
void expect_survey(const OutputPlan& plan);
/// \}

/// omega of omega²; negative, with the growth rate as its size, where omega² is: spectra with unstable branches are
/// drawn so.
double signed_root(double squared);

}  // namespace equidem
