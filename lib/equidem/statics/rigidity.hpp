// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Whether an assembly is held, as far as it follows without a factorization: rigid motions of its pieces and the
/// counter-rotation of discs (rigid_motions.hpp). Other mechanisms, such as the shear of a square lattice without
/// tangential springs, depend on every angle and show only in the factorization.
#pragma once

#include <cstdint>

#include "equidem/assembly/assembly.hpp"
#include "equidem/contact/contact_springs.hpp"
#include "equidem/linear/contact_graph.hpp"
#include "equidem/statics/number_unknowns.hpp"

namespace equidem {

/// Treatment of zero-energy modes.
enum class Mechanisms {
  refuse,  ///< an Error that names it
  hold,    ///< hold as many unknowns as there are such motions: FactorReport::zero_pivots
};

/// Refuse an assembly that can move without resistance.
/// \throws Error (bad_input) where there is no disc, a single free disc, a disc without contacts that is not held, a
///         piece that is not held, a rigid motion (named) that the supports leave free, or discs that can
///         counter-rotate, where mechanisms are refused
void check_rigidity(const Assembly& assembly, const ContactGraph& graph, const ContactSprings& springs,
                    const DegreesOfFreedom& unknowns, Mechanisms mechanisms = Mechanisms::refuse);

}  // namespace equidem
