// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Fixing zero-energy modes where that changes no force: rigid motions and gears of an assembly under balanced loads.
#pragma once

#include <cstdint>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/contact/contact_springs.hpp"
#include "equidem/linear/contact_graph.hpp"
#include "equidem/statics/number_unknowns.hpp"
#include "equidem/statics/rigid_motions.hpp"

namespace equidem {

struct HeldMotions {
  std::vector<std::size_t> components;  ///< disc * per_disc + k, one for each motion
  std::int64_t rigid = 0;
  std::vector<GearMode> gears;
};

/// Hold one component for each free rigid motion of a piece (that which the motion moves most) and the rotation of one
/// disc of each group of gears. The reactions are zero exactly where the loads do no work in those motions.
HeldMotions hold_free_motions(const Assembly& assembly, const ContactGraph& graph, const ContactSprings& springs,
                              DegreesOfFreedom& unknowns);

}  // namespace equidem
