// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The near pairs of all blocks of bodies in a step.
#pragma once

#include "equidem/grains/grain_system.hpp"

namespace equidem {

/// Set the impulses of all bodies to those by near pairs of discs and parts, and count their sums.
/// \param clear whether there are impulses to be removed before
void collide_near(GrainSystem& system, bool clear);

}  // namespace equidem
