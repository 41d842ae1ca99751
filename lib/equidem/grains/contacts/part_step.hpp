// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The contacts of a step in scenes with ellipses or clumps.
#pragma once

#include "equidem/grains/contacts/force_step.hpp"

namespace equidem {

/// The loop over contacts of parts compiled for a force law, with or without friction; null for other laws.
///
/// An impulse p at the contact point exerts arm x p on both bodies; velocities are those of the material points there.
/// Stiffness and dashpot are those of a central impact: c = 2 zeta sqrt(m k) with 1/m = 1/m_i + 1/m_j, without the arms
/// (Sukegawa 2010, (2.27)). An eccentric impact has the smaller mass m', 1/m' = 1/m + (arm_i x n)²/I_i + (arm_j x
/// n)²/I_j: its duration is shorter by sqrt(m'/m), and zeta' = zeta sqrt(m/m') makes its restitution smaller than
/// prescribed. The tangential dashpot is 2 zeta_T sqrt(m_T kT) with the tangential mass of the present arms.
CandidateLoop part_candidate_loop(NormalLaw law, bool friction);

}  // namespace equidem
