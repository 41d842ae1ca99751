// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The contacts of a step in scenes with ellipses or clumps.
#pragma once

#include "equidem/grains/contacts/force_step.hpp"

namespace equidem {

/// The loop over contacts of parts compiled for a force law, with or without friction; null for other laws.
///
/// An impulse p in the contact point turns both bodies by arm x p; velocities are those of the bodies' material there.
/// Stiffness and dashpot are those of a central impact: c = 2 zeta sqrt(m k) with 1/m = 1/m_i + 1/m_j, without the arms
/// (Sukegawa 2010, (2.27)). An impact whose normal passes by a centre has the smaller mass 1/m' = 1/m + (arm_i x
/// n)²/I_i + (arm_j x n)²/I_j: it lasts shorter by sqrt(m'/m), and zeta' = zeta sqrt(m/m') makes its restitution
/// smaller than what was asked for. The dashpot across the normal is
/// 2 zeta_T sqrt(m_T kT) with the tangential mass that the arms have at the time.
CollideFunction collide_parts_function(NormalLaw law, bool friction);

}  // namespace equidem
