// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// From the case file to what is computed on: the assembly and its springs.
#pragma once

#include <optional>
#include <string>

#include "equidem/assembly/assembly.hpp"
#include "equidem/casefile/case.hpp"
#include "equidem/contact/contact_springs.hpp"
#include "equidem/material/spring_relations.hpp"

namespace equidem {

/// The assembly of a case, checked, with cells measured and the groups of [[group]] added.
/// \throws Error (bad_input), with the line of the case file: no such file, a group that names an absent disc, holds
///         none or takes a name that is taken, a support or load on a group that does not exist
Assembly build_assembly(const Case& resolved);

/// The density rho of the discs themselves, kg/m³: that of [assembly], else gamma/phi, gamma that of [material] and phi
/// the solid fraction (Abe 1996, section 2). None where neither is given.
/// \throws Error (bad_input), with the line of the case file: both are given and gamma differs from rho phi by more
///         than 1e-6 of it; gamma alone is given for spheres, whose mass it does not tell
std::optional<double> disc_density(const Case& resolved, const Assembly& assembly);

/// The relation between springs and moduli (Abe 1996) that holds for a case: that of its lattice where springs are
/// equal, else the isotropic one, (20) and (21), with the measures that it asks for:
/// solid fraction and coordination number; of springs weighted by contact_density k psi = K/phi by (21); of springs
/// weighted by voronoi K = kN/2, since the facets of Voronoi cells obey sum h l = 2 V and uniform strain then stores
/// w = kN <(n e n)²>.
struct ChosenRelation {
  SpringRelation relation;
  IsotropicMeasures measures;
};
ChosenRelation spring_relation(const Case& resolved, const Assembly& assembly);

/// The springs of every contact and where they come from.
struct BuiltSprings {
  ContactSprings springs;
  std::optional<SpringConstants> constants;  ///< before weighting; none where the assembly file gives all springs
  std::string report;                        ///< one or two sentences for people
};

/// [material] is turned into springs by spring_relation.
/// \throws Error (bad_input), with the line of the case file: what the relation cannot represent, springs that
///         are missing or not positive
BuiltSprings build_springs(const Case& resolved, const Assembly& assembly);

}  // namespace equidem
