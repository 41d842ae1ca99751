// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A packing as a network of contacts with springs: what statics takes.
///
/// Bodies are those of the packing, numbered alike. Discs touch on the lines of their centres, with levers in
/// proportion to the radii. Of ellipses and clumps each contact has its normal and its point (ContactArms), each body
/// its section (BodySection) and the radius of the disc of equal area; clumps may touch in several places, with a
/// spring in each. A pair tied by dashpots counts as one rigid body: at rest dashpots resist nothing, and without them
/// the pair would fall apart, while over any time in which bodies move little they hold it. Springs are those given;
/// the forces at rest, where the packing carries some (carried_forces.hpp), go with the contacts.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/material/spring_constants.hpp"
#include "equidem/packing/packing.hpp"

namespace equidem {

struct NetworkOptions {
  std::optional<SpringConstants> springs = {};  ///< of every contact; none: left to the user of the network
  double gap_tolerance = 0;                     ///< of contacts_of
};

/// The bodies and the contacts between them.
Assembly network_of(const GrainPacking& packing, const NetworkOptions& options);

/// The network with walls as supports.
struct HeldNetwork {
  /// Contacts with a wall are ones with a body that mirrors it behind the wall; these are the group "walls": held, they
  /// resist as the wall does. Bodies with fewer than two contacts, which could roll, are left out one after the other.
  Assembly assembly;
  std::vector<std::int32_t> bodies;  ///< of the packing: the first of the assembly
};
HeldNetwork held_network_of(const GrainPacking& packing, const NetworkOptions& options);

}  // namespace equidem
