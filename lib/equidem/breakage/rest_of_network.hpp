// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The rest of a network once contacts have broken.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/breakage/breakable_system.hpp"
#include "equidem/contact/contact_springs.hpp"
#include "equidem/contact/frame.hpp"

namespace equidem {

/// The rest of a network, with its numbers in the whole.
struct RestOfNetwork {
  Assembly assembly;
  ContactSprings springs{SpringConstants{}};
  std::vector<std::int32_t> discs, contacts;  ///< of the whole, ascending
};

/// All discs and the contacts that are not broken. \param broken per contact, 1
RestOfNetwork unbroken_rest(const BreakableNetwork& network, const std::vector<std::uint8_t>& broken);

/// The discs of the rest that can carry a force (load_bearing.hpp), and their contacts. \param held per disc, 1
RestOfNetwork load_bearing_rest(const BreakableNetwork& network, const std::vector<std::uint8_t>& broken,
                                const std::vector<std::uint8_t>& held);

/// Discs of a network of `discs` that a rest lacks, per disc: 1.
std::vector<std::uint8_t> discs_outside(const RestOfNetwork& rest, std::size_t discs);

/// "a load drives " and the motion of a mechanism, with the numbers of discs in the whole.
/// \param rest whose discs and contacts count: what has left it may follow in more than one way
/// \param motions of all discs
std::string describe_driven(const BreakableNetwork& network, const RestOfNetwork& rest,
                            std::vector<DiscMotion> motions);

}  // namespace equidem
