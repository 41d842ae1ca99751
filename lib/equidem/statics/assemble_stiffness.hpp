// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Assembly of the stiffness matrix from the contact law.
#pragma once

#include "equidem/assembly/assembly.hpp"
#include "equidem/contact/contact_springs.hpp"
#include "equidem/linear/contact_graph.hpp"
#include "equidem/linear/degrees_of_freedom.hpp"
#include "equidem/linear/stiffness_matrix.hpp"

namespace equidem {

/// Tangent of the linear contact law, summed over contacts: K = sum kN g g^T + kT h h^T with the derivatives g, h of
/// stretch and slip. Rows and columns of held components are those of a unit matrix times the largest spring.
StiffnessMatrix assemble_stiffness(const Assembly& assembly, const ContactGraph& graph, const ContactSprings& springs,
                                   const DegreesOfFreedom& unknowns);

}  // namespace equidem
