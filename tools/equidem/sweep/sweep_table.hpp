// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The points of a sweep as a table that can be written, read back and continued.
#pragma once

#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "equidem/output/files/csv.hpp"
#include "equidem/output/results.hpp"

namespace equidem {

/// One point of a sweep. Numbers that are not known are NaN: empty in the CSV, null in JSON.
struct SweepPoint {
  static constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

  double value = 0;     ///< value of the key
  std::string status;   ///< "solved", "unstable", "failed"
  std::string message;  ///< of a point that failed: why
  double poisson_ratio = unknown;
  double stiffness_ratio = unknown;
  double theory_poisson_ratio = unknown;
  double theory_stiffness_ratio = unknown;
  double energy = unknown;  ///< N
  double relative_residual = unknown;
  double negative_pivots = unknown;
  double unstable_modes = unknown;
};

/// \param key name of the first column
Table sweep_table(const std::string& key, const std::vector<SweepPoint>& points);

/// Reads a table of sweep_table.
/// \throws Error (bad_input) where the file is another table or damaged
std::vector<SweepPoint> read_sweep_points(const std::filesystem::path& path, const std::string& key);

/// One row for each point: value (labelled by the key), status, the numbers, message.
std::vector<Results> sweep_rows(const std::string& key, const std::vector<SweepPoint>& points);

}  // namespace equidem
