// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A packing as a network of contacts with springs: what statics takes.
///
/// Bodies are those of the packing, numbered alike. Discs touch on the lines of their centres, with levers in
/// proportion to the radii. Of ellipses and clumps each contact has its normal and its point (ContactArms), each body
/// its section (BodySection) and the radius of the disc of equal area; clumps may touch in several places, with a
/// spring in each. A pair tied by dashpots counts as one rigid body: at rest dashpots resist nothing, and without them
/// the pair would fall apart, while over any time in which bodies move little they hold it. Springs are those given;
/// the forces at rest, where the packing carries some (network.hpp), go with the contacts.
///
/// The forces that the contacts of a packing carry at rest.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/contact/frame.hpp"
#include "equidem/material/spring_constants.hpp"
#include "equidem/packing/measures.hpp"
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

/// Bodies that fell carry the forces with which they came to rest; bodies that jammed -kN times the overlap, N/m, for
/// forces of equal springs balance there. Other packings carry none, for their overlaps balance nothing.
/// \param contacts of contacts_of(packing)
/// \param springs of every contact; none: of jammed bodies no forces are known
/// \return one for each contact, on its i (tension positive), or empty
std::vector<ContactForce> carried_forces(const GrainPacking& packing, const std::vector<PackingContact>& contacts,
                                         const std::optional<SpringConstants>& springs);

}  // namespace equidem
