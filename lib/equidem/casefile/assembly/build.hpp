// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Construction of the assembly and its springs from the case file.
#pragma once

#include <optional>
#include <string>

#include "equidem/assembly/assembly.hpp"
#include "equidem/casefile/assembly/case.hpp"
#include "equidem/contact/contact_springs.hpp"
#include "equidem/contact/material_springs.hpp"

namespace equidem {

/// The assembly of a case, checked, with cells measured and the groups of [[group]] added.
/// \throws Error (bad_input), with the line of the case file: no such file, a group that names an absent disc, is empty
///         or has a name in use, a support or load on a group that does not exist
Assembly build_assembly(const Case& resolved);

/// disc_density and spring_relation of a case.
/// \throws Error (bad_input), with the line of the case file
std::optional<double> disc_density(const Case& resolved, const Assembly& assembly);
ChosenRelation spring_relation(const Case& resolved, const Assembly& assembly);

/// The springs of every contact and their source.
struct BuiltSprings {
  ContactSprings springs;
  std::optional<SpringConstants> constants;  ///< before weighting; none if the assembly file gives all springs
  std::string report;                        ///< report, one or two sentences
};

/// [material] is turned into springs by spring_relation.
/// \throws Error (bad_input), with the line of the case file: what the relation cannot represent, springs that
///         are missing or not positive
BuiltSprings build_springs(const Case& resolved, const Assembly& assembly);

}  // namespace equidem
