// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// [viscoelastic] of a case: dashpots at the springs of every contact.
#pragma once

#include <complex>
#include <filesystem>
#include <optional>
#include <string_view>
#include <vector>

#include "equidem/casefile/engine/bind.hpp"
#include "equidem/material/spring_constants.hpp"
#include "equidem/material/viscoelasticity.hpp"

namespace equidem {

struct Case;

/// [viscoelastic]. The springs of the case, of whatever source, are the elastic ones that its models refer to.
struct ViscoelasticCase {
  Viscoelasticity springs;  ///< tables are completed by build_viscoelasticity
  std::optional<std::filesystem::path> path;
  /// Measured springs of the table of `path`, Pa, at a contact with the springs kN and kT of the case.
  struct Row {
    double frequency = 0;  ///< Hz
    SpringConstantsOf<std::complex<double>> springs;
  };
  std::vector<Row> rows;
  std::vector<double> frequencies;        ///< Hz; empty: by the other members
  std::optional<double> lowest, highest;  ///< Hz
  int per_decade = 5;
};

/// The springs over the elastic ones, checked.
/// \param constants of the case before weighting; none where each contact has springs of its own
/// \throws Error (bad_input), with the line of the case file: as check(ViscoelasticSpring), a table in Pa beside
///         springs of their own, or of a kT where the case has none
Viscoelasticity build_viscoelasticity(const Case& resolved, const std::optional<SpringConstants>& constants);

/// Frequencies of [viscoelastic], Hz.
/// \throws Error (bad_input), with the line of the case file
std::vector<double> frequencies_of(const Case& resolved, const Viscoelasticity& springs);

/// \throws Error (bad_input), with the line of the case file, where a verb has no answer for [viscoelastic]
void check_viscoelastic(const Case& resolved, std::string_view verb);

namespace casefile {

std::vector<Key<ViscoelasticCase>> viscoelastic_keys();

/// Reads the table, if there is one.
/// \param root the document
/// \throws Error (bad_input) with line and key: both springs elastic, a table without a path or the reverse, a file
///         that is no such table
void complete_viscoelastic(const TomlValue& root, ViscoelasticCase& viscoelastic);

}  // namespace casefile
}  // namespace equidem
