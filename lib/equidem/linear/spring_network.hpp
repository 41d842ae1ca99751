// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The parts that a stiffness matrix is made of.
#pragma once

#include "equidem/assembly/assembly.hpp"
#include "equidem/contact/contact_springs.hpp"
#include "equidem/linear/contact_graph.hpp"
#include "equidem/linear/degrees_of_freedom.hpp"

namespace equidem {

/// Discs, contacts, springs and unknowns, from which forces are evaluated.
struct SpringNetwork {
  const Assembly& assembly;
  const ContactGraph& graph;
  const ContactSprings& springs;
  const DegreesOfFreedom& unknowns;
};

}  // namespace equidem
