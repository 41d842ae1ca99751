// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Numbering of the unknowns of statics from effects and supports.
#pragma once

#include <span>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/contact/contact_springs.hpp"
#include "equidem/contact/effects.hpp"
#include "equidem/contact/frame.hpp"
#include "equidem/linear/contact_graph.hpp"
#include "equidem/statics/loads.hpp"

namespace equidem {

/// \throws Error (bad_input) where a support names no group or an empty one, prescribes a component twice with
///         different values, or prescribes a rotation that is not an unknown of the scene
DegreesOfFreedom number_unknowns(const Assembly& assembly, const ContactSprings& springs, const Effects& effects,
                                 std::span<const Support> supports);

/// Hold the components of the discs of a group that a support prescribes.
/// \throws Error (bad_input) as number_unknowns, but for a group that is empty or missing
void hold_group(const DiscGroup& discs, const Support& support, const Effects& effects, DegreesOfFreedom& unknowns);

/// Per disc, 1 where some contact resists its rotation: one off the line of centres, with kT != 0 and a lever arm, with
/// a bending spring, or with a force at rest that changes as the disc turns.
std::vector<std::uint8_t> resisted_rotations(const Assembly& assembly, const ContactSprings& springs);

/// Components (u_x, u_y[, a theta]) of all discs as their motions.
std::vector<DiscMotion> disc_motions(const DegreesOfFreedom& unknowns, std::span<const double> components);

}  // namespace equidem
