// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The samples of an ensemble as a table that can be written, read back and continued; their statistics as another.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "equidem/homogenize/ensemble/ensemble.hpp"
#include "equidem/homogenize/ensemble/ensemble_statistics.hpp"
#include "equidem/output/files/csv.hpp"

namespace equidem {

/// One row per cell: discs, seed, discs_built, the moduli, refusal.
Table samples_table(const std::vector<EnsembleSample>& samples);

/// Reads a table of samples_table; numbers have the same bits.
/// \throws Error (bad_input) where the file is another table or damaged
std::vector<EnsembleSample> read_samples(const std::filesystem::path& path);

/// One row per size: discs, mean_discs, samples, refused, and of each quantity the mean, standard deviation, standard
/// error and confidence limits.
Table statistics_table(const EnsembleStatistics& statistics);

}  // namespace equidem
