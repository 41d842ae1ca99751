// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Discs of a network with unbonded contacts that have come loose.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "equidem/breakage/breakable_system.hpp"
#include "equidem/breakage/unbonded/contact_law.hpp"
#include "equidem/statics/number_unknowns.hpp"

namespace equidem {

/// Discs that can carry no force (load_bearing.hpp) in the network of bonds and of contacts that carry one, ascending:
/// those that have left a network whose contacts do not rub.
/// \param network with all contacts
/// \param carried per contact: 1, whether it carries a force
std::vector<std::int32_t> loose_discs(const BreakableNetwork& network, std::span<const UnbondedLaw> laws,
                                      std::span<const ContactStatus> status, std::span<const std::uint8_t> carried);

/// Discs without a support of which every contact is open, ascending.
std::vector<std::int32_t> untouched_discs(const Assembly& assembly, const DegreesOfFreedom& unknowns,
                                          std::span<const ContactStatus> status);

}  // namespace equidem
