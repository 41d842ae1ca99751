// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Report and JSON of `equidem homogenize`.
#pragma once

#include <optional>
#include <string>

#include "equidem/homogenize/bounds.hpp"
#include "equidem/output/results.hpp"

#include "problem.hpp"

namespace equidem {

/// Moduli by Abe (1996) for the springs of the case.
struct RelationBeside {
  std::string name;  ///< "mean field, eqs. (21), (22)"
  double bulk_modulus_2d = 0;
  double shear_modulus = 0;
};

/// Report and JSON of the verb.
Results homogenized_results(const Problem& problem, const BoundedStiffness& homogenized,
                            const std::optional<RelationBeside>& relation);

}  // namespace equidem
