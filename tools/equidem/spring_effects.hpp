// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// What the springs of each contact do to numbers: report, JSON, sensitivities.csv, pictures and arrays of
/// --sensitivities.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "equidem/statics/adjoint.hpp"

#include "command.hpp"
#include "problem.hpp"

namespace equidem {

/// A number with its derivatives by the springs; without any where it has none.
struct SpringDependent : SpringDerivatives {
  std::string symbol;   ///< of the columns "dK_dkN": K
  std::string key;      ///< in the JSON, below the springs that change
  std::string heading;  ///< of the column of the report
  std::string unit;     ///< "Pa", "Hz", "m/s", ""
  double whole = 1;     ///< by which changes are divided
  bool listed = false;  ///< in a list with those of its key, which follow one another
  bool drawn = false;   ///< in a picture
};

/// Of a part of the output, and of its table where it has no suffix.
inline constexpr const char* sensitivities_name = "sensitivities.csv";

/// Changes by all springs of a kind, standard deviations where the springs of each contact scatter independently, and
/// the same by the springs of each pair of groups in [[springs.between]].
/// \param of_what "changes of the moduli", the begin of a sentence
Results spring_effects(const Problem& problem, std::span<const SpringDependent> numbers, const std::string& of_what);

/// A table with a row for each contact: contact, i, j, kN_Pa, kT_Pa, [kM_N,] and of each number its derivatives by
/// each spring; pictures, where [output] asks for some.
/// \param pictures symbols of the numbers that may have one
/// \param case_suffix of the names, "_pull"
std::vector<std::string> files_of_sensitivities(const OutputCase& wanted, std::span<const std::string> pictures,
                                                const std::string& case_suffix = {});
void write_sensitivities(const CommonOptions& options, const Problem& problem, std::span<const SpringDependent> numbers,
                         const std::string& case_suffix = {});

/// Memory of so many derivatives by each spring, a disc.
double bytes_of_sensitivities(const Problem& problem, double numbers);

/// dSYMBOL_dkN, dSYMBOL_dkT and, where contacts bend, dSYMBOL_dkM: (contacts); of a list dKEY_dkN: (contacts, numbers),
/// NaN where there is no derivative.
std::vector<ResultArray> sensitivity_arrays(std::span<const SpringDependent> numbers, const std::string& prefix = {});

}  // namespace equidem
