// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The samples of an ensemble as a table that can be written, read back and continued; their statistics as another.
/// The statistics of an ensemble for people, as JSON and as plots.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "equidem/homogenize/ensemble/ensemble.hpp"
#include "equidem/homogenize/ensemble/ensemble_statistics.hpp"
#include "equidem/output/files/csv.hpp"
#include "equidem/output/plots/plot.hpp"
#include "equidem/output/results.hpp"

namespace equidem {

/// One row per cell: discs, seed, discs_built, the moduli, refusal.
Table samples_table(const std::vector<EnsembleSample>& samples);

/// Reads a table of samples_table; numbers have the same bits.
/// \throws Error (bad_input) where the file is another table or damaged
std::vector<EnsembleSample> read_samples(const std::filesystem::path& path);

/// One row per size: discs, mean_discs, samples, refused, and of each quantity the mean, standard deviation, standard
/// error and confidence limits.
Table statistics_table(const EnsembleStatistics& statistics);

/// An ensemble as it was asked for, and what came of it.
struct EnsembleResult {
  std::string title;
  EnsemblePlan plan;
  std::optional<double> accuracy;  ///< relative, wanted
  std::vector<EnsembleSample> samples;
  EnsembleStatistics statistics;
};

/// Keys: ensemble: list of {discs, mean_discs, samples, refused, the quantities of `homogenize`, each {mean,
/// standard_deviation, standard_error, confidence_interval}}; scatter_exponent, size_limit and needed_discs of each
/// quantity but the anisotropy; title, confidence, accuracy, refusals.
Results ensemble_results(const EnsembleResult& result);

/// Names that ensemble_plots may use.
inline constexpr std::array ensemble_plot_names{"shear_modulus", "poisson_ratio", "scatter"};

/// Name and plot: means with their confidence limits and all samples against size, of G and of nu (plane strain); the
/// scatter of K, G and nu against size, where they scatter.
std::vector<std::pair<std::string, Plot>> ensemble_plots(const EnsembleResult& result);

}  // namespace equidem
