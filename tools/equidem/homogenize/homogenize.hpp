// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Report and JSON of `equidem homogenize`.
#pragma once

#include <optional>
#include <string>

#include "equidem/contact/contact_springs.hpp"
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

/// Adds the results to those of a problem. \param of_problem results that come first \param fabric none: not known
Results homogenized_results(const Problem& problem, Results of_problem, bool periodic,
                            const BoundedStiffness& homogenized, const std::optional<Fabric>& fabric,
                            const std::optional<RelationBeside>& relation);
/// Moduli by the relation of Abe (1996), where the springs stand for an isotropic continuum.
std::optional<RelationBeside> relation_beside(const SpringConstants& springs, const ChosenRelation& chosen);

}  // namespace equidem
