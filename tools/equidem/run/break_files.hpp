// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The bonds that broke in a run of grains: table, picture, lines of the report.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "equidem/casefile/grains/grain_case.hpp"
#include "equidem/grains/contacts/bond_breaking.hpp"
#include "equidem/output/results.hpp"

namespace equidem {

struct BreaksOfRun {
  std::span<const GrainBond> bonds;  ///< all that were made
  std::span<const BondBreak> breaks;
};

/// breaks.csv, in the order of time; with pictures breaks_plot, their places by mode.
void write_breaks(const std::filesystem::path& folder, const GrainCase& resolved, const BreaksOfRun& run,
                  double time_step, bool overwrite);

/// Their number by mode, the first one, and the energy of their springs.
void add_breaks(Results& out, const GrainCase& resolved, const BreaksOfRun& run, double time_step);

}  // namespace equidem
