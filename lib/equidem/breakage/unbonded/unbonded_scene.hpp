// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A path with contacts that rub begins with their laws and statuses; scenes that cannot have one are refused.
#pragma once

#include <span>
#include <vector>

#include "equidem/breakage/breakage_run.hpp"
#include "equidem/breakage/unbonded/contact_law.hpp"

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

}  // namespace equidem
