// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Validation: numbers that others have published, computed again with error bars.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "equidem/core/statistics.hpp"
#include "equidem/output/files/csv.hpp"
#include "equidem/output/plots/plot.hpp"

#include "papers.hpp"

namespace equidem::validation {

/// A published number; all of them stand in published.cpp.
struct Published {
  const char* key;
  double value;
  double error;        ///< standard error as published, or half a unit of the last digit; 0: exact
  const char* source;  ///< key of the source
};
struct Source {
  const char* key;
  const char* text;  ///< authors, year, title, place
};
std::span<const Source> sources();
/// The published number of that key, which must exist.
const Published& published(const std::string& key);

/// A number of ours with its error.
struct Estimate {
  double value = 0;
  double error = 0;  ///< standard error of the mean over samples, or the change where the step is refined
};
Estimate estimate_of(const MeanEstimate& mean);
Estimate mean_of(std::span<const double> samples);
/// \param coarse, fine results with a step and with a finer one
Estimate with_step_error(double coarse, double fine);

/// One published number beside ours.
struct Comparison {
  std::string quantity;
  Estimate theirs;
  std::string source;
  Estimate ours;
  /// Printed where the two differ: the reason known for it.
  std::string why = {};
  /// What the published number itself leaves out, as a theory that is an approximation does; added to its error.
  double allowance = 0;

  [[nodiscard]] double difference() const { return ours.value - theirs.value; }
  /// Standard error of the difference, and round-off.
  [[nodiscard]] double error() const;
  /// Whether the difference is at most 2.6 standard errors (99 % of a normal distribution), plus the allowance.
  [[nodiscard]] bool agrees() const;
  [[nodiscard]] std::string verdict() const;
};
Comparison compare(std::string quantity, const std::string& published_key, Estimate ours, std::string why = {});
/// With a formula in place of a number. \param source key
Comparison compare_formula(std::string quantity, double formula, std::string source, Estimate ours,
                           std::string why = {});

/// A statement without a number, decided by ours.
struct Trend {
  std::string statement;
  std::string source;
  bool holds = false;
  std::string evidence;
};

/// What an item found.
struct Findings {
  std::string text;  ///< paragraphs of the page before the table
  std::vector<Comparison> comparisons;
  std::vector<Trend> trends;
  std::vector<std::string> notes;  ///< what was not compared, and why
  Named<Table> tables;
  Named<Plot> plots;
};

/// An item of the page. `compute` shows its own progress.
struct Item {
  const char* name;
  const char* heading;
  Findings (*compute)(bool quick);
  std::vector<std::string> plots;   ///< names of its plots
  std::vector<std::string> tables;  ///< names of its tables, whose files end in _values.csv
};
std::span<const Item> items();

Findings bond_dilution(bool quick);
Findings site_dilution(bool quick);
Findings adsorption(bool quick);
Findings jamming(bool quick);
Findings friction(bool quick);
Findings impacts(bool quick);
Findings lammps(bool quick);
Findings point_load(bool quick);
Findings disc_moduli(bool quick);

struct Section {
  const Item* item = nullptr;
  Findings findings;
  double seconds = 0;  ///< wall time

  [[nodiscard]] std::size_t agreements() const;  ///< of comparisons and trends
  [[nodiscard]] std::size_t statements() const;
};
/// The page, in Markdown, for the folder above that of the figures, which is called validation.
std::string page(const std::vector<Section>& sections, bool quick);
/// The same in short, for the screen.
std::string report(const std::vector<Section>& sections);

/// Bars of +- one standard error at the points of a series, as a series without a label.
Series error_bars(const Series& points, std::span<const double> errors);

/// Call body(sample) for all samples, thread_count() at once, with progress and interruption.
void for_samples(const std::string& task, std::size_t samples, const std::function<void(std::size_t)>& body);

}  // namespace equidem::validation
