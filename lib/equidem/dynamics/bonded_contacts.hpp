// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Forces of bonds and walls on discs.
#pragma once

#include <vector>

#include "equidem/contact/body_contact.hpp"
#include "equidem/dynamics/simulation.hpp"

namespace equidem {

/// All bonds in the order of the assembly, then the walls that push, with the forces of their springs on discs
/// displaced by `motions`; arms and shifts are those of the start.
std::vector<BodyContact> bonded_contacts(const Scene& scene, LoopKind::Motion motion,
                                         const std::vector<DiscMotion>& motions, double time);

}  // namespace equidem
