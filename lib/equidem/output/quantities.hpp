// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Units and meanings of the numbers of results, written in result.json as the objects "units" and "labels".
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "equidem/output/results.hpp"

namespace equidem {

/// Unit and meaning of a number of results; those that a verb states itself come before it.
struct ResultQuantity {
  std::string path;         ///< its keys, "/" between those of nested objects
  std::string unit;         ///< symbol, "Pa"; empty: a count or a ratio
  std::string label;        ///< "shear modulus G"
  bool of_machine = false;  ///< it depends on the machine, on the time or on how often a computation was interrupted
};
/// The rows of quantities.csv.
const std::vector<ResultQuantity>& result_quantities();

/// The meaning by the keys of the number, "/" between those of nested objects, positions in lists left out or not; none
/// where it is not known. A meaning of "shear_modulus" is also that of "bounds/shear_modulus" and, with the rest of its
/// keys, that of "shear_modulus/mean".
std::optional<ResultQuantity> meaning_of(std::string_view path);

/// Objects "units" and "labels" with an entry for each number, vector and matrix of the results that has a meaning;
/// keys of nested objects are joined by '.', positions in lists left out: "points.energy".
Results units_and_labels(const Results& results);

/// A single number of a result.
struct ScalarNumber {
  std::string path;  ///< keys and positions in lists, with "/" between them
  std::string unit;  ///< symbol; empty: none, or not known
  std::string text;  ///< shortest form that reads back to the same bits
};
/// All finite single numbers that do not depend on the machine, in the order of the results; those of vectors and
/// matrices are left out.
std::vector<ScalarNumber> scalar_numbers(const Results& results);

/// Name of a column of a table: keys joined by '.', then the unit, "density.discs_kg_per_m3".
std::string column_name(std::string_view path, std::string_view unit);
/// The number whose column_name this is, without its text.
ScalarNumber number_of_column(std::string_view column);

/// Describes result.json and lists all meanings, as text.
std::string describe_result();

}  // namespace equidem
