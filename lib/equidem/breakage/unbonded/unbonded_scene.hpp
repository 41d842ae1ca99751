// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A path with frictional contacts begins with their laws and statuses; scenes that cannot have one are refused.
/// Rattlers of such a network.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "equidem/breakage/breakage_run.hpp"
#include "equidem/breakage/unbonded/contact_law.hpp"
#include "equidem/statics/number_unknowns.hpp"

namespace equidem {

/// \param rest N/m, forces at rest per contact; empty: none
std::vector<UnbondedLaw> laws_of(const BreakageScene& scene, double friction, std::span<const ContactForce> rest);

/// A contact whose strengths are both 0 is no bond; it is open where its force at rest pulls.
std::vector<ContactStatus> first_status(const BreakageScene& scene, std::span<const UnbondedLaw> laws);

/// \throws Error (bad_input) where the control is none of those that a path with a history has
void check_control_of_rubbing(const LoadPath& path);

/// \throws Error (bad_input) where the friction is not a finite number >= 0, forces at rest are beyond it, or
///         check_control_of_rubbing() says so
void check_rubbing(const BreakageScene& scene, double friction, std::span<const ContactForce> rest);

/// Discs that can carry no force (load_bearing.hpp) in the network of bonds and of contacts that carry one, ascending:
/// those that have left a network whose contacts are not frictional.
/// \param network with all contacts
/// \param carried per contact: 1, whether it carries a force
std::vector<std::int32_t> loose_discs(const BreakableNetwork& network, std::span<const UnbondedLaw> laws,
                                      std::span<const ContactStatus> status, std::span<const std::uint8_t> carried);

/// Discs without a support of which every contact is open, ascending.
std::vector<std::int32_t> untouched_discs(const Assembly& assembly, const DegreesOfFreedom& unknowns,
                                          std::span<const ContactStatus> status);

}  // namespace equidem
