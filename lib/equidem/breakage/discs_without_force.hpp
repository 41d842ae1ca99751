// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Discs that can carry no force any more.
#pragma once

#include <cstdint>
#include <vector>

#include "equidem/breakage/breakable_system.hpp"

namespace equidem {

/// Discs of the network without some contacts (load_bearing.hpp). \param broken per contact, `held` per disc, 1
/// \return per disc, 1: it can carry no force
std::vector<std::uint8_t> discs_without_force(const BreakableNetwork& network, const std::vector<std::uint8_t>& broken,
                                              const std::vector<std::uint8_t>& held);

}  // namespace equidem
