// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The keys that a sweep varies, and its points as a table that can be written, read back and continued.
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "equidem/casefile/engine/toml.hpp"
#include "equidem/output/files/csv.hpp"
#include "equidem/output/quantities.hpp"
#include "equidem/output/results.hpp"

#include "command.hpp"

namespace equidem {

/// A key as it is given on the command line.
struct KeyOptions {
  std::string name;                 ///< "springs.kT"; "ratio": kT/kN at the kN of the case
  std::optional<double> from, to;   ///< both, or `values`
  int steps = 11;                   ///< number of values from `from` to `to`
  std::vector<std::string> values;  ///< lists "a,b,c" of numbers and words
};

/// A key and its values. Values are numbers in the shortest form that reads back to the same bits, or words.
struct SweptKey {
  std::string name;
  std::string unit;  ///< empty: none
  std::vector<std::string> values;

  [[nodiscard]] bool numeric() const;
  /// The value for report and JSON, a number where it is one.
  static ResultValue shown(const std::string& value);
};

/// Each key takes each of its values, the last key fastest; side by side all keys but the seed take their k-th values
/// together.
struct SweepPlan {
  static constexpr const char* seed = "seed";  ///< name of the key that --seeds varies; it is the last one

  std::string verb;
  std::vector<SweptKey> keys;
  bool side_by_side = false;
  std::vector<std::string> waves = {};  ///< probes of a run whose standing waves are measured

  [[nodiscard]] double points() const;  ///< their number, of a plan that may have too many
  [[nodiscard]] std::size_t size() const { return static_cast<std::size_t>(points()); }
  /// One value for each key.
  [[nodiscard]] std::vector<std::string> values_of(std::size_t point) const;
  [[nodiscard]] bool has_seeds() const { return keys.back().name == seed; }
  /// Number of keys but the seed.
  [[nodiscard]] std::size_t keys_of_case() const { return keys.size() - (has_seeds() ? 1 : 0); }
  /// "springs.kT, seed".
  [[nodiscard]] std::string names() const;
};

/// \param seeds lists "1,2,3" and ranges "1-5"
/// \throws Error (bad_input) without keys and seeds; a key without values, with values and a range, or given twice; a
///         value that is neither a finite number nor a word; lists of unequal length side by side; too many points
SweepPlan sweep_plan(const std::string& verb, const std::vector<KeyOptions>& keys,
                     const std::vector<std::string>& seeds, bool side_by_side);

/// Options of the command line, "--set" and "--seed", that give the keys of a case their values.
/// \param base document of the case, for the key "ratio"
std::vector<std::string> options_of(const SweepPlan& plan, const std::vector<std::string>& values,
                                    const TomlValue& base);

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

/// One row a point: point, the keys, status, every number that some point has, message; units are in the names.
Table sweep_table(const SweepPlan& plan, std::span<const SweepPoint> points);

/// Reads a table of sweep_table.
/// \throws Error (bad_input) where the file is another table or damaged
std::vector<SweepPoint> read_sweep_points(const std::filesystem::path& path, const SweepPlan& plan);

/// One row for each point: number, keys, status, the numbers as in the result of the verb, message. "value" is that of
/// the first key.
std::vector<Results> sweep_rows(const SweepPlan& plan, std::span<const SweepPoint> points);

/// Files of the plots that a sweep may have; none where its keys have no curves: the first is a word or the seed, or
/// more than two vary independently.
std::vector<std::string> files_of_curves(const SweepPlan& plan);

/// Draws each main quantity that some point has against the first key: one line for each value of the second; of
/// several seeds the points and their mean. Points that are not stable are open and left out of the mean.
/// \param title of the plots; empty: what is varied
/// \throws Error (bad_input) as write_plot
void write_curves(const std::filesystem::path& folder, const SweepPlan& plan, std::span<const SweepPoint> points,
                  const std::string& title);

}  // namespace equidem
