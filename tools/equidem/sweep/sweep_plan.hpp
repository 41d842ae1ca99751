// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The points of a sweep: which keys take which values.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "equidem/casefile/engine/toml.hpp"
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

}  // namespace equidem
