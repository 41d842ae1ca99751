// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The points of a sweep as a table that can be written, read back and continued.
/// Main quantities of a sweep over its first key.
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
  Shown shown = {.digits = 8};
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

/// Names of the plots that a sweep may have; none where its keys have no curves: the first is a word or the seed, or
/// more than two vary independently.
std::vector<std::string> curve_names(const SweepPlan& plan);

/// Draws each main quantity that some point has against the first key: one line for each value of the second; of
/// several seeds the points and their mean. Points that are not stable are open and left out of the mean.
/// \param title of the plots; empty: what is varied
/// \throws Error (bad_input) as write_plot
void write_curves(const std::filesystem::path& folder, const SweepPlan& plan, std::span<const SweepPoint> points,
                  const std::string& title);

}  // namespace equidem
