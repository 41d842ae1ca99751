// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The points of a sweep as a table that can be written, read back and continued.
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "equidem/output/files/csv.hpp"
#include "equidem/output/quantities.hpp"
#include "equidem/output/results.hpp"

#include "sweep/sweep_plan.hpp"

namespace equidem {

/// One point of a sweep.
struct SweepPoint {
  static constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

  std::int64_t number = 0;            ///< from 1
  std::vector<std::string> values;    ///< of the keys
  std::string status;                 ///< of the result of the verb, "solved", "unstable"; or "failed"
  std::string message;                ///< of a point that failed: why
  std::vector<ScalarNumber> numbers;  ///< of the result of the verb

  [[nodiscard]] bool failed() const { return status == "failed"; }
  /// The number with these keys; null where there is none.
  [[nodiscard]] const ScalarNumber* find(std::string_view path) const;
  /// Its value; NaN where there is none.
  [[nodiscard]] double at(std::string_view path) const;
};

/// A main quantity of a verb: a column of the report, and the curves.
struct MainQuantity {
  std::string verb;
  std::string path;         ///< '*': the name of a wave
  std::string heading;      ///< in the report
  std::string axis = "";    ///< label of the curve; empty: not drawn
  std::string theory = "";  ///< path of the number that theory gives
  Shown::As shown = Shown::As::number;
  int digits = 8;
};
std::vector<MainQuantity> main_quantities(const SweepPlan& plan);

/// One row a point: point, the keys, status, every number that some point has, message; units are in the names.
Table sweep_table(const SweepPlan& plan, std::span<const SweepPoint> points);

/// Reads a table of sweep_table.
/// \throws Error (bad_input) where the file is another table or damaged
std::vector<SweepPoint> read_sweep_points(const std::filesystem::path& path, const SweepPlan& plan);

/// One row for each point: number, keys, status, the numbers as in the result of the verb, message. "value" is that of
/// the first key.
std::vector<Results> sweep_rows(const SweepPlan& plan, std::span<const SweepPoint> points);

}  // namespace equidem
